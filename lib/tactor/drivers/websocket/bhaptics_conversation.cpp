// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/bhaptics_conversation.h"

#include <algorithm>
#include <utility>

namespace tactor {

namespace {

bool
is_on(const std::vector<int> &intensities)
{
  return std::ranges::any_of(intensities, [](int level) { return level > 0; });
}

/// Names of connected devices that have this position.
bool
is_connected(const bhaptics::Status &status, std::string_view position)
{
  const std::string_view device = position.starts_with("Vest") ? "Vest" : position;
  return std::ranges::any_of(
             status.positions,
             [&](const std::string &name) { return name == device || name == position; })
         || (status.is_asleep && device == "Vest");
}

/// Where a position is on the wearer.
std::string_view
place_of(std::string_view position)
{
  constexpr std::pair<std::string_view, std::string_view> kPlaces[] = {
    { "VestBack", "back" },      { "VestFront", "front" }, { "ForearmL", "left arm" },
    { "ForearmR", "right arm" }, { "Head", "visor" },
  };
  const auto *place
      = std::ranges::find(kPlaces, position, [](const auto &one) { return one.first; });
  return place == std::end(kPlaces) ? position : place->second;
}

/// In the order of tactors.
std::vector<std::string>
names_of_motors(const SuitPart &part)
{
  const int side_by_side = static_cast<int>(part.positions.size()) / part.layout.panels;
  const int width = part.layout.columns / side_by_side;
  std::vector<std::string> names;
  for (int panel = 0; panel < part.layout.panels; panel++)
    for (int row = 0; row < part.layout.rows; row++)
      for (int column = 0; column < part.layout.columns; column++) {
        const auto position = static_cast<std::size_t>(panel * side_by_side + column / width);
        names.push_back(std::string(place_of(part.positions[position])) + ", row "
                        + std::to_string(row + 1) + ", column "
                        + std::to_string(column % width + 1));
      }
  return names;
}

std::string
joined(const auto &names)
{
  std::string text;
  for (const auto &name : names)
    text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

} // namespace

const std::vector<SuitPart> &
suit_parts()
{
  // Grids as the layouts of bHaptics' own effects have them (haptic-library, *.tact).
  static const std::vector<SuitPart> parts{
    { "vest-back", { "VestBack" }, { .rows = 5, .columns = 4 } },
    { "vest-front", { "VestFront" }, { .rows = 5, .columns = 4 } },
    { "vest", { "VestBack", "VestFront" }, { .rows = 5, .columns = 4, .panels = 2 } },
    { "sleeves", { "ForearmL", "ForearmR" }, { .rows = 2, .columns = 6 } },
    { "sleeve-left", { "ForearmL" }, { .rows = 2, .columns = 3 } },
    { "sleeve-right", { "ForearmR" }, { .rows = 2, .columns = 3 } },
    { "visor", { "Head" }, { .rows = 1, .columns = 6 } },
  };
  return parts;
}

tl::expected<SuitPart, DriverError>
find_suit_part(const std::string &name)
{
  std::vector<std::string_view> names;
  for (const SuitPart &part : suit_parts()) {
    if (name.empty() || name == part.name)
      return part;
    names.push_back(part.name);
  }
  return tl::unexpected(
      DriverError{ DriverError::Kind::settings,
                   "device names '" + name + "', which no suit has; expected " + joined(names) });
}

BhapticsConversation::BhapticsConversation(std::string server, SuitPart part,
                                           BhapticsPatience patience)
    : server_(std::move(server)), part_(std::move(part)), patience_(patience),
      answers_(part_.positions, patience.answers)
{
}

std::vector<std::string>
BhapticsConversation::parts() const
{
  return { part_.positions.begin(), part_.positions.end() };
}

void
BhapticsConversation::begin(Time now)
{
  enter(State::asking);
  wanted_.assign(static_cast<std::size_t>(part_.layout.tactors()), 0);
  sent_ = wanted_;
  answers_.begin();
  is_connected_ = false;
  greets_at_ = now + patience_.hello;
}

void
BhapticsConversation::received(std::string_view text, Time now)
{
  const std::optional<bhaptics::Status> status = bhaptics::read_status(text);
  if (!status || (state() != State::asking && state() != State::playing))
    return;
  answers_.heard(*status, now);
  take(*status);
}

void
BhapticsConversation::take(const bhaptics::Status &status)
{
  std::vector<std::string_view> missing;
  for (const std::string_view position : part_.positions)
    if (!is_connected(status, position))
      missing.push_back(position);
  if (missing.size() == part_.positions.size()) {
    const std::string others
        = status.positions.empty() ? "nothing" : "only " + joined(status.positions);
    fail({ DriverError::Kind::not_found, server_ + ": expected " + joined(part_.positions)
                                             + " for device=" + std::string(part_.name) + ", and "
                                             + others
                                             + " is connected; switch it on and pair it there" });
    return;
  }
  if (!missing.empty())
    warn(server_ + ": " + joined(missing) + " is not connected, and will not be felt");
  is_connected_ = true;
  if (greets_at_)
    greets_at_ = Time::min();
}

void
BhapticsConversation::set_levels(std::span<const double> levels)
{
  for (std::size_t i = 0; i < wanted_.size(); i++)
    wanted_[i] = i < levels.size() ? bhaptics::intensity(levels[i] > 0 ? levels[i] : 0) : 0;
}

std::optional<std::string>
BhapticsConversation::next(Time now)
{
  if (state() == State::closing) {
    enter(State::closed);
    return write_zeros(now);
  }
  if (state() != State::asking && state() != State::playing)
    return std::nullopt;
  if (greets_at_ && now >= *greets_at_) {
    greets_at_.reset();
    return write_zeros(now);
  }
  if (const std::optional<Time> time = plays_at(); time && now >= *time) {
    enter(State::playing);
    if (!answers_.has_answered())
      warn(server_
           + " answers nothing: whether the motors run is not known; restart it if they "
             "do not");
  }
  if (const std::optional<Time> silent = silent_at(); silent && now >= *silent) {
    fail({ DriverError::Kind::failed,
           server_ + ": expected a status, and none came for "
               + std::to_string(
                   std::chrono::duration_cast<std::chrono::seconds>(patience_.answer).count())
               + " s; restart it" });
    return std::nullopt;
  }
  if (const std::optional<Time> time = due(); time && now >= *time)
    return write_changes(now);
  return std::nullopt;
}

std::optional<Time>
BhapticsConversation::deadline() const
{
  if (state() == State::closing)
    return Time::min();
  if (state() != State::asking && state() != State::playing)
    return std::nullopt;
  if (greets_at_)
    return greets_at_;
  std::optional<Time> first;
  for (const std::optional<Time> time : { due(), silent_at(), plays_at() })
    if (time)
      first = std::min(first.value_or(Time::max()), *time);
  return first;
}

void
BhapticsConversation::close(Time)
{
  if (state() != State::closing && state() != State::closed)
    enter(greets_at_ ? State::closed : State::closing);
}

ServedDevice
BhapticsConversation::device() const
{
  return { .name = std::string(part_.name) + " by " + server_,
           .server = "bHaptics",
           .tactors = part_.layout.tactors(),
           .motors = names_of_motors(part_),
           .layout = part_.layout,
           .step = 0.01,
           .longest_latency = patience_.longest_latency,
           .has_watchdog = true };
}

Time
BhapticsConversation::latency() const
{
  return std::min(answers_.latency(), patience_.longest_latency);
}

/// A message that ends what this program plays at all positions.
std::string
BhapticsConversation::write_zeros(Time now)
{
  std::ranges::fill(sent_, 0);
  std::vector<bhaptics::Frame> frames;
  for (std::size_t i = 0; i < part_.positions.size(); i++)
    frames.push_back(frame(i, sent_));
  return write(frames, now);
}

/// A message with the wanted intensities of positions that are on or change. Before its turn only
/// motors stop.
std::string
BhapticsConversation::write_changes(Time now)
{
  const bool hurries = now < turn();
  Intensities next = wanted_;
  for (std::size_t i = 0; hurries && i < next.size(); i++)
    next[i] = wanted_[i] == 0 ? 0 : sent_[i];
  std::vector<bhaptics::Frame> frames;
  for (std::size_t i = 0; i < part_.positions.size(); i++) {
    bhaptics::Frame wanted = frame(i, next);
    const bool is_new = wanted.intensities != frame(i, sent_).intensities;
    if (is_new || (!hurries && is_on(wanted.intensities)))
      frames.push_back(std::move(wanted));
  }
  sent_ = std::move(next);
  return write(frames, now);
}

std::string
BhapticsConversation::write(std::span<const bhaptics::Frame> frames, Time now)
{
  std::vector<std::string_view> playing;
  for (std::size_t i = 0; i < part_.positions.size(); i++)
    if (is_on(frame(i, sent_).intensities))
      playing.push_back(part_.positions[i]);
  const Time duration = answers_.duration();
  answers_.sent(std::move(playing), now);
  sent_at_ = now;
  return bhaptics::write_submit(frames, duration);
}

/// When the first message was listened to for long enough.
std::optional<Time>
BhapticsConversation::plays_at() const
{
  return state() == State::asking && is_connected_ && !greets_at_ ? answers_.listens_until()
                                                                  : std::nullopt;
}

/// When the wanted intensities are to be sent, if ever.
std::optional<Time>
BhapticsConversation::due() const
{
  if (state() != State::playing || greets_at_ || (wanted_ == sent_ && !is_on(wanted_)))
    return std::nullopt;
  for (std::size_t i = 0; answers_.is_quick() && i < wanted_.size(); i++)
    if (wanted_[i] == 0 && sent_[i] != 0)
      return sent_at_; // a zero, at once
  return turn();
}

/// When any intensities may be sent, or those that are on again.
Time
BhapticsConversation::turn() const
{
  const Time interval = wanted_ != sent_ ? patience_.interval : patience_.answers.renewal;
  return std::max(sent_at_ + interval, answers_.ready_at());
}

/// When the server has not answered for too long. One that never did plays for all we know.
std::optional<Time>
BhapticsConversation::silent_at() const
{
  const std::optional<Time> since = answers_.waits_since();
  if (!since || (state() == State::playing && !answers_.has_answered()))
    return std::nullopt;
  return *since + patience_.answer;
}

/// The motors of a position. Tactors go row by row over the positions of a panel.
bhaptics::Frame
BhapticsConversation::frame(std::size_t position, const Intensities &intensities) const
{
  const auto columns = static_cast<std::size_t>(part_.layout.columns);
  const std::size_t side_by_side
      = part_.positions.size() / static_cast<std::size_t>(part_.layout.panels);
  const std::size_t width = columns / side_by_side;
  const std::size_t panel = position / side_by_side;
  const std::size_t left = position % side_by_side * width;
  bhaptics::Frame frame{ .position = part_.positions[position], .intensities = {} };
  for (std::size_t row = 0; row < static_cast<std::size_t>(part_.layout.rows); row++)
    for (std::size_t column = 0; column < width; column++) {
      const std::size_t line = panel * static_cast<std::size_t>(part_.layout.rows) + row;
      frame.intensities.push_back(intensities[line * columns + left + column]);
    }
  return frame;
}

} // namespace tactor
