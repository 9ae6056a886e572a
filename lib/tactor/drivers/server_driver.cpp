// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/server_driver.h"

#include "tactor/realtime/realtime_thread.h"
#include "tactor/unlocked.h"

#include <algorithm>
#include <utility>

namespace tactor {

namespace {

constexpr std::size_t kMostTold = 8; ///< reasons that a server is not used

/// Claims the devices of the server's conversation for this driver alone.
tl::expected<DeviceClaim, DriverError>
claim(const Server &server)
{
  std::set<std::string> devices;
  std::string names;
  for (const std::string &part : server.conversation->parts()) {
    devices.insert(part + " of " + server.name);
    names += (names.empty() ? "'" : ", '") + part + "'";
  }
  std::optional<DeviceClaim> mine = DeviceClaim::make(std::move(devices));
  if (!mine)
    return tl::unexpected(DriverError{
        DriverError::Kind::busy, server.name + ": expected " + names
                                     + " to be free, and another tactorsink of this program plays "
                                       "there; set device to another one" });
  return std::move(*mine);
}

} // namespace

/// A connection, from its opening to its end.
struct ServerDriver::Visit
{
  Server &server;
  std::unique_ptr<MessageSocket> socket;
  Conversation &talk = *server.conversation;
  Time begun = steady_now();
  bool is_connected = false;
  bool was_taken = false;              ///< the device played
  std::optional<DriverError> ending{}; ///< why it is over, or will be
  bool tries_again = false;
  bool is_closing = false;
  bool is_over = false;
  Time second = steady_now(); ///< in which messages are counted
  int messages = 0;

  void end(const Conversation &failed)
  {
    ending = failed.failure();
    tries_again = failed.tries_again();
  }
};

ServerDriver::ServerDriver(MakeServer make_server)
    : ServerDriver(std::move(make_server), Settings{})
{
}

ServerDriver::ServerDriver(MakeServer make_server, Settings settings)
    : make_server_(std::move(make_server)), settings_(settings)
{
}

ServerDriver::~ServerDriver()
{
  ServerDriver::close();
}

/* ---- the caller's side ---- */

void
ServerDriver::reset()
{
  told_.clear();
  device_ = {};
  latency_ = Time(0);
}

void
ServerDriver::wake(Lock & /*lock*/)
{
  levels_written();
}

Layout
ServerDriver::layout() const
{
  const std::lock_guard lock(mutex_);
  return device_.layout.tactors() <= tactors_ ? device_.layout : Layout{};
}

double
ServerDriver::resolution() const
{
  const std::lock_guard lock(mutex_);
  return device_.step * config_.full_scale_volts;
}

Time
ServerDriver::transport_latency() const
{
  const std::lock_guard lock(mutex_);
  return latency_;
}

Time
ServerDriver::longest_latency() const
{
  const std::lock_guard lock(mutex_);
  return device_.longest_latency;
}

Time
ServerDriver::refresh_interval() const
{
  return settings_.refresh;
}

void
ServerDriver::levels_written()
{
  if (socket_ != nullptr)
    socket_->wake();
}

/* ---- the driver's thread ---- */

void
ServerDriver::run(Lock &lock)
{
  tl::expected<Server, DriverError> server
      = without(lock, [&] { return make_server_(config_.device); });
  std::optional<DeviceClaim> mine;
  if (server) {
    if (tl::expected<DeviceClaim, DriverError> claimed = claim(*server))
      mine.emplace(std::move(*claimed));
    else
      server = tl::unexpected(claimed.error());
  }
  RealtimeThread realtime(config_.realtime);
  Time pause = settings_.look_again;
  while (server && !quit_) {
    const Time begun = steady_now();
    const bool was_there = status_.is_there;
    const DriverError ending = visit(lock, *server, realtime);
    if (quit_)
      break;
    if (!is_open_) {
      refuse(ending);
      break;
    }
    if (std::exchange(status_.is_there, false))
      tell(lock, DriverEvent::Kind::lost, ending.text);
    else if (!was_there && ending.kind != DriverError::Kind::lost)
      tell_refusal(lock, ending);
    if (steady_now() - begun > settings_.longest_look_again)
      pause = settings_.look_again;
    changed_.wait_for(lock, pause, [this] { return quit_; });
    pause = std::min(2 * pause, settings_.longest_look_again);
  }
  if (!server)
    refuse(server.error());
  else if (!is_open_ && quit_)
    refuse({ DriverError::Kind::failed, "the opening of the device was stopped" });
  {
    const Unlocked unlocked(lock);
    server = {};
  }
}

/// One connection, or several if the server needs them. Returns why it ended.
DriverError
ServerDriver::visit(Lock &lock, Server &server, RealtimeThread &realtime)
{
  while (true) {
    Visit visit{ .server = server, .socket = without(lock, server.connect) };
    socket_ = visit.socket.get();
    while (!visit.is_over) {
      realtime.turn();
      turn(lock, visit);
    }
    socket_ = nullptr;
    stand();
    {
      const Unlocked unlocked(lock);
      visit.socket.reset();
    }
    if (!visit.tries_again || quit_)
      return visit.ending.value_or(DriverError{});
  }
}

/// Sends what is to be sent, and waits for what comes.
void
ServerDriver::turn(Lock &lock, Visit &visit)
{
  using State = Conversation::State;
  Conversation &talk = visit.talk;
  const Time now = steady_now();
  if (const std::optional<Time> silent = silent_at(); silent && now >= *silent)
    levels_.clear();
  if (!visit.is_connected && (quit_ || now >= visit.begun + settings_.answer)) {
    visit.ending = { DriverError::Kind::lost,
                     visit.server.name + " does not answer; see " + visit.server.page };
    visit.is_over = true;
    return;
  }
  if (visit.is_connected) {
    talk.set_levels(levels(now));
    if (talk.state() == State::failed && !visit.ending)
      visit.end(talk);
    if ((quit_ || visit.ending) && !std::exchange(visit.is_closing, true))
      talk.close(now);
    const Unlocked unlocked(lock);
    while (const std::optional<std::string> text = talk.next(now))
      visit.socket->send(*text);
  }
  for (const std::string &warning : talk.take_warnings())
    tell(lock, DriverEvent::Kind::warning, warning);
  if (visit.is_closing && talk.state() == State::closed) {
    visit.is_over = true;
    return;
  }
  if (talk.state() == State::failed && visit.is_connected)
    return; // the next turn closes
  if (talk.state() == State::playing)
    latency_ = talk.latency();
  if (talk.state() == State::playing && !std::exchange(visit.was_taken, true)) {
    visit.ending = take(lock, visit.server);
    return;
  }
  Time until = now + settings_.answer;
  const auto by = [&](std::optional<Time> time) {
    until = std::min(until, time.value_or(until));
  };
  by(visit.is_connected ? talk.deadline() : visit.begun + settings_.answer);
  by(silent_at());
  by(levels_end());
  const SocketEvent event = without(lock, [&] { return visit.socket->wait(until); });
  receive(visit, event, steady_now());
}

void
ServerDriver::receive(Visit &visit, const SocketEvent &event, Time now)
{
  switch (event.kind) {
  case SocketEvent::Kind::none:
    break;
  case SocketEvent::Kind::opened:
    visit.is_connected = true;
    visit.talk.begin(now);
    break;
  case SocketEvent::Kind::message:
    if (now >= visit.second + std::chrono::seconds(1)) {
      visit.second = now;
      visit.messages = 0;
    }
    if (++visit.messages > settings_.most_messages)
      visit.ending
          = { DriverError::Kind::lost, visit.server.name + ": expected at most "
                                           + std::to_string(settings_.most_messages)
                                           + " messages a second, and more came; restart it" };
    else
      visit.talk.received(event.text, now);
    break;
  case SocketEvent::Kind::closed:
    visit.is_over = true;
    if (!visit.is_connected) {
      visit.ending = { is_open_ ? DriverError::Kind::lost : DriverError::Kind::not_found,
                       "expected " + visit.server.name + ", and it cannot be reached: " + event.text
                           + "; start it, and see " + visit.server.page };
    } else if (!visit.ending) {
      visit.talk.hung_up(visit.server.name + " closed the connection: " + event.text);
      visit.end(visit.talk);
    }
    break;
  }
}

/// The server has the device. Returns why it is not used.
std::optional<DriverError>
ServerDriver::take(Lock &lock, const Server &server)
{
  const ServedDevice device = server.conversation->device();
  const int tactors = std::min(device.tactors, config_.max_tactors);
  if (tactors < config_.min_tactors)
    return DriverError{ DriverError::Kind::settings,
                        device.name + ": mapping needs " + std::to_string(config_.min_tactors)
                            + " tactors, and it has " + std::to_string(tactors)
                            + "; set mapping to tactors below that" };
  if (is_open_ && (tactors != tactors_ || device.layout != device_.layout))
    return DriverError{ DriverError::Kind::settings,
                        device.name + ": expected " + std::to_string(tactors_)
                            + " motors as before, found " + std::to_string(tactors)
                            + "; stop the film and play it again" };
  status_.board = device.name;
  status_.firmware = device.server;
  status_.motors.assign(device.motors.begin(), device.motors.begin() + tactors);
  status_.has_watchdog = device.has_watchdog;
  status_.is_there = true;
  if (is_open_) {
    status_.reconnects++;
    told_.clear();
    tell(lock, DriverEvent::Kind::returned, device.name + " is back");
    return std::nullopt;
  }
  tactors_ = tactors;
  device_ = device;
  use_account(server.name + " " + device.name);
  tell(lock, DriverEvent::Kind::opened,
       device.name + ": " + std::to_string(tactors) + " motors, " + device.server);
  opened();
  return std::nullopt;
}

void
ServerDriver::tell_refusal(Lock &lock, const DriverError &why)
{
  if (told_.size() < kMostTold && told_.insert(why.text).second)
    tell(lock, DriverEvent::Kind::refused, why.text);
}

/// When the levels are zero unless write() is called.
std::optional<Time>
ServerDriver::silent_at() const
{
  if (std::ranges::none_of(levels_, [](double level) { return level > 0; }))
    return std::nullopt;
  return written_at_ + settings_.host_silence;
}

} // namespace tactor
