// SPDX-License-Identifier: LGPL-2.1-or-later
#include "player_choice.h"

using follow::Doing;

int
PlayerChoice::rank(const Candidate &player, follow::Time now) const
{
  if (player.doing != Doing::playing)
    return player.doing == Doing::paused ? 1 : 0;
  if (player.is_faulty)
    return 2;
  if (!player.is_heard)
    return 4;
  const bool is_old = played_ && player.found < *played_ + kMemory && now < *played_ + 2 * kMemory;
  return is_old ? 0 : 3;
}

std::optional<std::size_t>
PlayerChoice::choose(std::span<const Candidate> players, std::optional<std::size_t> current,
                     follow::Time now)
{
  constexpr int kPlays = 2;
  constexpr int kReports = 4;
  std::optional<std::size_t> best = current;
  for (std::size_t i = 0; i < players.size(); i++)
    if (const int its = rank(players[i], now);
        its > (best ? rank(players[*best], now) : 0)
        && (its >= kPlays || !best || players[*best].doing == Doing::stopped))
      best = i;
  if (best && rank(players[*best], now) == kReports)
    played_ = now;
  return best;
}
