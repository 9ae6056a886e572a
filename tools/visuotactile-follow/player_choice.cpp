// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player_choice.h"

#include <algorithm>

using follow::Doing;
using follow::Source;

namespace {

constexpr int kPlays = 2;
constexpr int kReports = 5;

} // namespace

int
PlayerChoice::rank(const Candidate &player, follow::Time now) const
{
  if (player.doing != Doing::playing)
    return player.doing == Doing::paused ? 1 : 0;
  if (player.is_faulty)
    return kPlays;
  if (player.source != Source::listener)
    return player.source == Source::media_server ? 3 : kReports;
  const auto is_old = [&](const std::optional<follow::Time> &played) {
    return played && player.found < *played + kMemory && now < *played + 2 * kMemory;
  };
  return is_old(played_) || (!coarse_plays_ && is_old(coarse_played_)) ? 0 : 4;
}

std::optional<std::size_t>
PlayerChoice::choose(std::span<const Candidate> players, std::optional<std::size_t> current,
                     follow::Time now)
{
  coarse_plays_ = std::ranges::any_of(players, [](const Candidate &one) {
    return one.source == Source::media_server && one.doing == Doing::playing;
  });
  if (coarse_plays_)
    coarse_played_ = now;
  std::optional<std::size_t> best = current;
  if (best && players[*best].doing == Doing::playing && rank(players[*best], now) == 0)
    best.reset(); // sound of a film that has stopped
  for (std::size_t i = 0; i < players.size(); i++)
    if (const int its = rank(players[i], now);
        its > (best ? rank(players[*best], now) : 0)
        && (its >= kPlays || !best || players[*best].doing == Doing::stopped))
      best = i;
  if (best && rank(players[*best], now) == kReports)
    played_ = now;
  return best;
}
