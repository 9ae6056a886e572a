// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/buttplug_conversation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>

namespace tactor {

using buttplug::Id;

namespace {

constexpr Time kShortestPing = std::chrono::milliseconds(10);

/// No level that is wanted.
constexpr int kUnknown = -1;

std::vector<std::string>
split(const std::string &names)
{
  std::vector<std::string> all;
  std::istringstream text(names);
  for (std::string name; std::getline(text, name, ',');)
    if (!name.empty())
      all.push_back(name);
  return all;
}

const std::string &
name_of(const buttplug::Device &device)
{
  return device.display_name.empty() ? device.name : device.display_name;
}

std::string
quoted(const auto &names)
{
  std::string text;
  for (const std::string &name : names)
    text += (text.empty() ? "'" : ", '") + name + '\'';
  return text;
}

} // namespace

ButtplugConversation::ButtplugConversation(std::string server, const std::string &names,
                                           ButtplugPatience patience)
    : server_(std::move(server)), names_(split(names)), patience_(patience)
{
}

std::vector<std::string>
ButtplugConversation::parts() const
{
  return names_;
}

void
ButtplugConversation::begin(Time now)
{
  enter(State::asking);
  step_ = Step::greeting;
  outbox_.clear();
  taken_.clear();
  ping_.reset();
  info_ = {};
  asked_at_ = ping_at_ = now;
  asked_ = new_id();
  outbox_.push_back(buttplug::write_request_server_info(asked_, version_));
}

void
ButtplugConversation::received(std::string_view text, Time now)
{
  const auto messages = buttplug::read_messages(text);
  if (!messages) {
    warn(server_
         + ": expected messages of the Buttplug protocol, got something else; is it "
           "Intiface?");
    return;
  }
  for (const buttplug::Message &message : *messages)
    if (state() != State::failed && state() != State::closed)
      take_any(message, now);
}

void
ButtplugConversation::hung_up(const std::string &why)
{
  if (state() == State::asking && step_ == Step::greeting)
    try_older(why);
  else
    Conversation::hung_up(why);
}

/* ---- messages ---- */

/// As std::visit(), which may throw.
template <class... Kinds>
void
ButtplugConversation::take_any(const std::variant<Kinds...> &message, Time now)
{
  const auto take_if = [&](const auto *one) {
    if (one != nullptr)
      take(*one, now);
  };
  (take_if(std::get_if<Kinds>(&message)), ...);
}

void
ButtplugConversation::take(const buttplug::ServerInfo &info, Time now)
{
  if (state() != State::asking || step_ != Step::greeting)
    return;
  if (info.version < buttplug::kOldest || info.version > version_) {
    fail({ DriverError::Kind::failed,
           server_ + ": expected version 3 or 4 of the Buttplug protocol, got "
               + std::to_string(info.version) + "; update it" });
    return;
  }
  version_ = info.version;
  info_ = info;
  step_ = Step::listing;
  asked_at_ = now;
  asked_ = new_id();
  outbox_.push_back(buttplug::write_request_device_list(asked_));
}

void
ButtplugConversation::take(const buttplug::Ok &ok, Time now)
{
  for (Taken &taken : taken_)
    if (std::ranges::find(taken.unanswered, ok.id) != taken.unanswered.end())
      taken.errors = 0;
  answered(ok.id, true, now);
}

void
ButtplugConversation::take(const buttplug::Error &error, Time now)
{
  const std::string text = error.text.empty() ? "an error without a text" : error.text;
  if (state() == State::asking && step_ == Step::greeting) {
    try_older(text);
    return;
  }
  if (state() == State::asking && step_ == Step::listing) {
    fail({ DriverError::Kind::failed, server_ + " does not list its devices: " + text });
    return;
  }
  if (state() != State::closing)
    warn(server_ + ": " + text);
  for (Taken &taken : taken_) {
    if (std::ranges::find(taken.unanswered, error.id) == taken.unanswered.end())
      continue;
    // The state of the device is unknown: all levels are sent again, zeros, too.
    std::ranges::fill(taken.sent, kUnknown);
    if (++taken.errors >= kMostErrors && state() == State::playing) {
      lose(taken, text);
      return;
    }
  }
  answered(error.id, false, now);
}

void
ButtplugConversation::take(const buttplug::DeviceList &list, Time now)
{
  if (state() == State::asking && step_ == Step::listing) {
    choose(list.devices, now);
    return;
  }
  // Version 4 sends the whole list when a device came or went.
  for (const Taken &taken : taken_)
    if (std::ranges::none_of(list.devices, [&](const buttplug::Device &listed) {
          return listed.index == taken.device.index && listed.name == taken.device.name
                 && listed.vibrators == taken.device.vibrators;
        })) {
      lose(taken, "it was switched off, is out of reach, or has other motors than before");
      return;
    }
}

void
ButtplugConversation::take(const buttplug::DeviceRemoved &removed, Time)
{
  for (const Taken &taken : taken_)
    if (taken.device.index == removed.index) {
      lose(taken, "it was switched off, or is out of reach");
      return;
    }
}

/// Takes the devices that the user named.
void
ButtplugConversation::choose(const std::vector<buttplug::Device> &devices, Time now)
{
  std::vector<std::string> found;
  for (const buttplug::Device &device : devices)
    found.push_back(name_of(device));
  const std::string others
      = found.empty() ? "it has no devices; switch yours on and have Intiface scan for it"
                      : "it has " + quoted(found) + "; set device to one of these";
  if (names_.empty()) {
    fail({ DriverError::Kind::settings,
           server_ + ": expected device to name a device, as only named devices are used; "
               + others });
    return;
  }
  std::vector<Taken> chosen;
  for (const std::string &name : names_) {
    const auto device = std::ranges::find_if(devices, [&](const buttplug::Device &one) {
      return (one.name == name || one.display_name == name)
             && std::ranges::none_of(
                 chosen, [&](const Taken &taken) { return taken.device.index == one.index; });
    });
    if (device == devices.end()) {
      fail({ DriverError::Kind::not_found,
             server_ + ": expected a device '" + name + "', and " + others });
      return;
    }
    if (device->vibrators.empty()) {
      fail({ DriverError::Kind::settings, server_ + ": expected '" + name + "' to vibrate in 1 to "
                                              + std::to_string(buttplug::kMostSteps)
                                              + " steps, and it does not; take another device" });
      return;
    }
    chosen.push_back({ .device = *device,
                       .wanted = std::vector<int>(device->vibrators.size()),
                       .sent = std::vector<int>(device->vibrators.size()),
                       .unanswered = {} });
  }
  taken_ = std::move(chosen);
  step_ = Step::stopping;
  asked_at_ = now;
  stop_all(now);
}

/// The reply to a message came. Replies of success give the latency.
void
ButtplugConversation::answered(Id id, bool is_done, Time now)
{
  if (ping_ == id)
    ping_.reset();
  for (Taken &taken : taken_)
    if (std::erase(taken.unanswered, id) > 0 && taken.unanswered.empty() && is_done)
      taken.answers.add(now - taken.sent_at);
  if (step_ == Step::stopping && state() == State::asking && is_stopped()) {
    step_ = Step::done;
    if (info_.max_ping_time == Time(0))
      warn(server_
           + " requires no pings: its devices may run on if this computer hangs; set a "
             "ping time in Intiface");
    enter(State::playing);
  } else if (state() == State::closing && is_stopped()) {
    enter(State::closed);
  }
}

void
ButtplugConversation::stop_all(Time now)
{
  for (Taken &taken : taken_) {
    const Id id = new_id();
    taken.unanswered.clear();
    sends(taken, { id }, now);
    std::ranges::fill(taken.sent, 0);
    outbox_.push_back(buttplug::write_stop(id, taken.device.index, version_));
  }
}

bool
ButtplugConversation::is_stopped() const
{
  return std::ranges::all_of(taken_, [](const Taken &taken) { return taken.unanswered.empty(); });
}

void
ButtplugConversation::lose(const Taken &taken, const std::string &why)
{
  fail({ DriverError::Kind::lost, name_of(taken.device) + " by " + server_ + ": " + why });
}

/// The server did not take the greeting. Servers of version 3 do not know that of version 4.
void
ButtplugConversation::try_older(const std::string &why)
{
  const bool is_newest = version_ == buttplug::kNewest;
  version_ = is_newest ? buttplug::kOldest : buttplug::kNewest;
  fail({ DriverError::Kind::failed, server_ + " does not take this program: " + why }, is_newest);
}

/* ---- what is sent ---- */

void
ButtplugConversation::set_levels(std::span<const double> levels)
{
  std::size_t tactor = 0;
  for (Taken &taken : taken_)
    for (std::size_t i = 0; i < taken.wanted.size(); i++, tactor++) {
      const double level = tactor < levels.size() && levels[tactor] > 0 ? levels[tactor] : 0;
      taken.wanted[i]
          = static_cast<int>(std::lround(std::min(level, 1.0) * taken.device.vibrators[i].steps));
    }
}

std::optional<std::string>
ButtplugConversation::next(Time now)
{
  if (state() == State::failed || state() == State::closed)
    return std::nullopt;
  if (!outbox_.empty()) {
    std::string text = std::move(outbox_.front());
    outbox_.erase(outbox_.begin());
    return text;
  }
  if (state() == State::closing) {
    if (now >= asked_at_ + patience_.closing)
      enter(State::closed);
    return std::nullopt;
  }
  if (const std::optional<Time> silent = silent_at(); silent && now >= *silent) {
    fail({ DriverError::Kind::failed,
           server_ + ": expected an answer, and none came for "
               + std::to_string(
                   std::chrono::duration_cast<std::chrono::seconds>(patience_.answer).count())
               + " s; restart it" });
    return std::nullopt;
  }
  const Time interval = std::max(info_.max_ping_time / 2, kShortestPing);
  if (step_ != Step::greeting && info_.max_ping_time > Time(0) && !ping_
      && now >= ping_at_ + interval) {
    ping_ = new_id();
    ping_at_ = now;
    return buttplug::write_ping(*ping_);
  }
  if (state() == State::playing)
    for (Taken &taken : taken_)
      if (std::optional<std::string> command = next_command(taken, now))
        return command;
  return std::nullopt;
}

/// The vibrators of a device that change, in one message. Before its turn only those that stop.
std::optional<std::string>
ButtplugConversation::next_command(Taken &taken, Time now)
{
  const std::optional<Time> time = due(taken);
  if (!time || now < *time)
    return std::nullopt;
  const std::optional<Time> its_turn = turn(taken);
  const bool hurries = !its_turn || now < *its_turn;
  if (!hurries && std::exchange(taken.has_hurried, false))
    std::ranges::replace(taken.sent, 0, kUnknown);
  std::vector<buttplug::Value> values;
  for (std::size_t i = 0; i < taken.wanted.size(); i++)
    if (taken.wanted[i] != taken.sent[i] && (!hurries || taken.wanted[i] == 0)) {
      values.push_back({ taken.device.vibrators[i], taken.wanted[i] });
      taken.sent[i] = taken.wanted[i];
    }
  taken.has_hurried = hurries;
  std::vector<Id> ids(buttplug::count_commands(values.size(), version_));
  const Id first = new_id(static_cast<Id>(ids.size()));
  std::iota(ids.begin(), ids.end(), first);
  sends(taken, std::move(ids), now);
  return buttplug::write_values(first, taken.device.index, values, version_);
}

void
ButtplugConversation::sends(Taken &taken, std::vector<Id> ids, Time now)
{
  if (taken.unanswered.empty())
    taken.waits_since = now;
  taken.unanswered.insert(taken.unanswered.end(), ids.begin(), ids.end());
  taken.sent_at = now;
}

/// When a device may be sent any values: once all was answered and the gap is over.
std::optional<Time>
ButtplugConversation::turn(const Taken &taken) const
{
  if (!taken.unanswered.empty())
    return std::nullopt;
  return taken.sent_at + taken.device.gap.value_or(patience_.gap);
}

/// When a device is to be sent its wanted values, if they are new.
std::optional<Time>
ButtplugConversation::due(const Taken &taken) const
{
  for (std::size_t i = 0; i < taken.wanted.size(); i++)
    if (taken.wanted[i] == 0 && taken.sent[i] != 0)
      return taken.sent_at; // a zero, at once
  return taken.wanted != taken.sent || taken.has_hurried ? turn(taken) : std::nullopt;
}

/// When the server has not answered for too long.
std::optional<Time>
ButtplugConversation::silent_at() const
{
  std::optional<Time> first;
  const auto add = [&](Time since) {
    first = std::min(first.value_or(Time::max()), since + patience_.answer);
  };
  if (state() == State::asking)
    add(asked_at_);
  if (ping_)
    add(ping_at_);
  for (const Taken &taken : taken_)
    if (!taken.unanswered.empty())
      add(taken.waits_since);
  return first;
}

std::optional<Time>
ButtplugConversation::deadline() const
{
  if (state() == State::failed || state() == State::closed)
    return std::nullopt;
  if (!outbox_.empty())
    return Time::min();
  if (state() == State::closing)
    return asked_at_ + patience_.closing;
  std::optional<Time> first = silent_at();
  const auto add = [&](Time time) {
    first = std::min(first.value_or(Time::max()), time);
  };
  if (step_ != Step::greeting && info_.max_ping_time > Time(0) && !ping_)
    add(ping_at_ + std::max(info_.max_ping_time / 2, kShortestPing));
  if (state() == State::playing)
    for (const Taken &taken : taken_)
      if (const std::optional<Time> time = due(taken))
        add(*time);
  return first;
}

void
ButtplugConversation::close(Time now)
{
  if (state() == State::closing || state() == State::closed)
    return;
  enter(taken_.empty() ? State::closed : State::closing);
  outbox_.clear();
  asked_at_ = now;
  stop_all(now);
}

ServedDevice
ButtplugConversation::device() const
{
  ServedDevice served{ .name = {},
                       .server = (info_.name.empty() ? "Intiface" : info_.name) + ", Buttplug "
                                 + std::to_string(version_),
                       .longest_latency = patience_.longest_latency,
                       .has_watchdog = info_.max_ping_time > Time(0) };
  for (const Taken &taken : taken_) {
    served.name += (served.name.empty() ? "" : ", ") + name_of(taken.device);
    served.tactors += static_cast<int>(taken.device.vibrators.size());
    for (const buttplug::Vibrator &vibrator : taken.device.vibrators) {
      served.step = std::max(served.step, 1.0 / vibrator.steps);
      served.motors.push_back(name_of(taken.device) + ", motor "
                              + std::to_string(&vibrator - taken.device.vibrators.data() + 1));
    }
  }
  served.name += " by " + server_;
  served.layout = { .rows = 1, .columns = served.tactors };
  return served;
}

Time
ButtplugConversation::latency() const
{
  Time slowest{ 0 };
  for (const Taken &taken : taken_)
    slowest = std::max(slowest, taken.answers.median());
  return std::min(slowest, patience_.longest_latency);
}

/// The first of `count` Ids in a row, none of them 0.
Id
ButtplugConversation::new_id(Id count)
{
  if (last_id_ > std::numeric_limits<Id>::max() - count)
    last_id_ = 0;
  const Id first = last_id_ + 1;
  last_id_ += count;
  return first;
}

} // namespace tactor
