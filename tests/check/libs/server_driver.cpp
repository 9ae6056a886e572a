// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The drivers of devices behind a server, with servers of the real protocols that are written with
// another library (support/haptic_server.py). The order of what the servers saw is asserted, not
// when.
#include "tactor/drivers/server_driver.h"
#include "tactor/drivers/registry.h"

#include "support/contains.h"
#include "support/haptic_server.h"
#include "support/unwrap.h"

#include <condition_variable>
#include <dlfcn.h>
#include <memory>
#include <mutex>
#include <thread>
#include <tuple>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using Kind = DriverError::Kind;
using EventKind = DriverEvent::Kind;

namespace {

const char *const kVibrator = "Test Vibrator";

struct Rig
{
  explicit Rig(MakeServer make, int most_messages = 1000)
      : driver(std::move(make), settings(most_messages))
  {
  }

  static ServerDriver::Settings settings(int most_messages)
  {
    // A driver that looks again at once, and does not end levels that are not written again.
    return { .answer = 30s,
             .host_silence = 1h,
             .look_again = 1ms,
             .longest_look_again = 2ms,
             .most_messages = most_messages };
  }

  DriverConfig config(const std::string &device, int min_tactors = 1)
  {
    return { .device = device, .min_tactors = min_tactors, .notify = [this](const auto &event) {
              const std::lock_guard lock(mutex);
              events.push_back(event);
              changed.notify_all();
            } };
  }
  void open(const std::string &device)
  {
    unwrap(driver.open(config(device)));
  }
  DriverError refusal(const std::string &device, int min_tactors = 1)
  {
    DriverError error = refusal_of(driver.open(config(device, min_tactors)));
    ck_assert_int_eq(driver.tactors(), 0);
    return error;
  }
  void write(std::initializer_list<double> volts)
  {
    unwrap(driver.write(std::vector(volts), 0s));
  }
  /// For a server: it writes another level for each message that was taken.
  std::function<void(const std::string &, HapticServer::Clock::time_point)> at_each_message()
  {
    return [this, level = 0](const std::string &line, auto) mutable {
      if (line.starts_with("waiting "))
        write({ 0.15 * (1 + level++ % 20), 0.0 });
    };
  }
  /// Waits for an event of this kind, and returns the last one.
  DriverEvent wait_for(EventKind kind, std::ptrdiff_t times = 1)
  {
    std::unique_lock lock(mutex);
    changed.wait(lock,
                 [&] { return std::ranges::count(events, kind, &DriverEvent::kind) >= times; });
    const auto last = std::find_if(events.rbegin(), events.rend(),
                                   [&](const DriverEvent &event) { return event.kind == kind; });
    return *last;
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<DriverEvent> events;
  ServerDriver driver;
};

/// Each server with its driver, and what its motors do.
struct Case
{
  const char *kind;
  MakeServer make;
  const char *device;
  const char *half; ///< a line of the server for 1.5 V on the first motor
  const char *zero;
};

const std::vector<Case> &
cases()
{
  static const std::vector<Case> all{
    { "bhaptics", make_bhaptics_server, "vest-back", "motors VestBack 0=50", "motors VestBack" },
    { "buttplug3", make_intiface_server, kVibrator, "motors 0 0=0.5", "motors 0" },
    { "buttplug4", make_intiface_server, kVibrator, "motors 0 0=10", "motors 0" },
  };
  return all;
}

} // namespace

CHECK_TEST(test_levels)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind, "ping=300" });
    Rig rig(one.make);
    rig.open(server.device(one.device));
    fail_unless(rig.driver.status().is_there && rig.driver.status().has_watchdog);
    fail_unless(rig.driver.layout().tactors() == rig.driver.tactors());
    server.wait_for_line(one.zero); // whatever they did before
    rig.write({ 1.5 });
    server.wait_for_line(one.half);
    rig.write({ 0, 0 });
    server.wait_for_line(one.zero);
    rig.write({ 1.5 });
    server.wait_for_line(one.half);
    rig.driver.close();
    server.wait_for_line(one.zero);
    server.wait_for("gone");
  }
}

/// Whoever writes the levels goes on for ever: the driver's thread ends them.
CHECK_TEST(test_limits)
{
  HapticServer server({ "buttplug4" });
  ServerDriver driver(make_intiface_server);
  DriverConfig config{ .device = server.device(kVibrator) };
  config.limits.max_on_time = 100ms;
  unwrap(driver.open(config));
  server.wait_for_line("motors 0");
  const std::jthread writer([&](const std::stop_token &stop) {
    while (!stop.stop_requested()) {
      unwrap(driver.write(std::array{ 1.5 }, 0s));
      std::this_thread::yield();
    }
  });
  server.wait_for_line("motors 0 0=10");
  server.wait_for_line("motors 0");
}

/// The server's pings are answered for as long as it is open.
CHECK_TEST(test_pings)
{
  HapticServer server({ "buttplug4", "ping=20" });
  Rig rig(make_intiface_server);
  rig.open(server.device(kVibrator));
  for (int i = 0; i < 5; i++)
    server.wait_for("got [{\"Ping\"");
}

/// Levels that nobody writes again end.
CHECK_TEST(test_host_silence)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind });
    ServerDriver driver(one.make, { .host_silence = 50ms });
    unwrap(driver.open({ .device = server.device(one.device) }));
    server.wait_for_line(one.zero);
    {
      const std::jthread writer([&](const std::stop_token &stop) {
        while (!stop.stop_requested()) {
          unwrap(driver.write(std::array{ 1.5 }, 0s));
          std::this_thread::yield();
        }
      });
      server.wait_for_line(one.half);
    }
    server.wait_for_line(one.zero);
  }
}

/// A child process plays until it is killed. The duration ends the level.
CHECK_TEST(test_killed)
{
  HapticServer server({ "bhaptics" });
  const pid_t child = fork();
  if (child == 0) {
    Rig rig(make_bhaptics_server);
    rig.open(server.device("vest-back"));
    rig.write({ 1.5 });
    while (true)
      pause();
  }
  server.wait_for_line("motors VestBack 0=50");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  server.wait_for_line("expired VestBack");
}

/// A child process plays until SIGTERM, which it does not survive.
CHECK_TEST(test_zero_on_signal)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind });
    const pid_t child = fork();
    if (child == 0) {
      (void)std::signal(SIGTERM, SIG_DFL); // check catches it
      Rig rig(one.make);
      rig.open(server.device(one.device));
      rig.write({ 1.5 });
      while (true)
        pause();
    }
    server.wait_for_line(one.half);
    kill(child, SIGTERM);
    server.wait_for_line(one.zero);
    int status = 0;
    waitpid(child, &status, 0);
    fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
  }
}

/// A server that takes 200 ms for each message: nothing waits behind the one that it has, though
/// levels change all the time.
CHECK_TEST(test_slow_server)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind, "slow=200" });
    Rig rig(one.make);
    rig.open(server.device(one.device));
    const std::jthread writer([&](const std::stop_token &stop) {
      for (int i = 0; !stop.stop_requested(); i++) {
        unwrap(rig.driver.write(std::array{ 0.15 * (1 + i % 20), 0.0 }, 0s)); // zeros do not wait
        std::this_thread::yield();
      }
    });
    for (int i = 0; i < 6; i++)
      server.wait_for("waiting");
    for (const std::string &waiting : server.lines("waiting"))
      assert_text(waiting, "waiting 0");
  }
}

/// The server goes away and comes back. The levels are those written meanwhile.
CHECK_TEST(test_lost_and_back)
{
  for (const Case &one : cases()) {
    auto server = std::make_unique<HapticServer>(std::vector<std::string>{ one.kind });
    const std::string port = server->port();
    Rig rig(one.make);
    rig.open(server->device(one.device));
    rig.write({ 3, 3 });
    server->wait_for("motors");
    server.reset();
    assert_contains(rig.wait_for(EventKind::lost).text, { "closed the connection" });
    fail_if(rig.driver.status().is_there);
    rig.write({ 1.5 });
    server = std::make_unique<HapticServer>(std::vector<std::string>{ one.kind, "port=" + port });
    assert_contains(rig.wait_for(EventKind::returned).text, { one.device, "is back" });
    server->wait_for_line(one.half);
    fail_unless(rig.driver.status().reconnects == 1);
  }
}

/// The server has no such device any more, and has it again.
CHECK_TEST(test_device_lost_and_back)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind });
    Rig rig(one.make);
    rig.open(server.device(one.device));
    rig.write({ 1.5 });
    server.wait_for_line(one.half);
    server.say("remove");
    rig.wait_for(EventKind::lost);
    assert_contains(rig.wait_for(EventKind::refused).text, { "expected" });
    server.say("add");
    rig.wait_for(EventKind::returned);
    server.wait_for_line(one.half);
    const std::lock_guard lock(rig.mutex);
    ck_assert_int_eq(std::ranges::count(rig.events, EventKind::refused, &DriverEvent::kind), 1);
  }
}

/// Whatever a server does to a device that plays: which bound acted is told, and the server is
/// looked for again.
CHECK_TEST(test_bad_servers)
{
  for (const Case &one : cases())
    for (const auto &[behavior, most_messages, why] :
         { std::tuple{ "huge=6", 1000, "larger than configured max-incoming-payload-size" },
           // Few, as a sanitizer may read no faster than that.
           std::tuple{ "flood=6", 10, "expected at most 10 messages a second, and more came" },
           std::tuple{ "drops=6", 1000,
                       "closed the connection: " }, // by whom depends on what was under way
           std::tuple{ "goodbye=6", 1000, "closed the connection: it said goodbye, code 1001" } }) {
      Rig rig(one.make, most_messages);
      HapticServer server({ one.kind, behavior, "gap=1" }, rig.at_each_message());
      rig.open(server.device(one.device));
      rig.write({ 3, 0 });
      for (int i = 1; i <= 2; i++)
        assert_contains(rig.wait_for(EventKind::lost, i).text, { why });
      const std::lock_guard lock(rig.mutex);
      ck_assert_int_ge(std::ranges::count(rig.events, EventKind::returned, &DriverEvent::kind), 1);
    }
}

/// A server that reads nothing is left before what it was sent takes much memory.
CHECK_TEST(test_deaf_server)
{
  HapticServer deaf({ "bhaptics", "deaf=1" });
  const Server server = unwrap(make_bhaptics_server(deaf.device("vest-back")));
  const std::unique_ptr<MessageSocket> socket = server.connect();
  const std::string message(64 * 1024, 'x');
  std::size_t sent = 0;
  SocketEvent event;
  while (event.kind != SocketEvent::Kind::closed) {
    event = socket->wait(Time::max());
    ck_assert_int_ne(static_cast<int>(event.kind), static_cast<int>(SocketEvent::Kind::none));
    for (int i = 0; i < 1024 && event.kind != SocketEvent::Kind::closed; i++, sent++) {
      socket->send(message);
      event = socket->wait(Time(0)); // what can go goes
    }
  }
  assert_text(event.text, "it does not read what is sent");
  ck_assert_uint_lt(sent, 1024); // the system's buffers have 64 MiB at most
}

/// The latency follows the server, up to what is planned for.
CHECK_TEST(test_latency)
{
  for (const Case &one : cases()) {
    Rig rig(one.make);
    HapticServer server({ one.kind, "slow=40", "gap=1" }, rig.at_each_message());
    rig.open(server.device(one.device));
    fail_unless(rig.driver.longest_latency() == 150ms);
    rig.write({ 3, 0 });
    const auto play_until = [&](Time least, Time most) {
      while (rig.driver.transport_latency() < least || rig.driver.transport_latency() > most)
        server.wait_for("waiting");
    };
    play_until(40ms, 119ms);
    server.say("slow=120");
    play_until(120ms, 150ms);
    server.say("slow=0");
    play_until(0ms, 39ms);
    server.say("slow=400");
    play_until(150ms, 150ms);
    // What was measured last holds while the server is lost.
    server.say("quit");
    rig.wait_for(EventKind::lost);
    fail_unless(rig.driver.transport_latency() == 150ms);
  }
}

CHECK_TEST(test_refused_commands)
{
  HapticServer server({ "buttplug4", "refuses=3" });
  Rig rig(make_intiface_server);
  rig.open(server.device(kVibrator));
  rig.write({ 3 });
  assert_contains(rig.wait_for(EventKind::warning).text, { "requires no pings" });
  assert_contains(rig.wait_for(EventKind::warning, 2).text, { "the device did not answer" });
}

/// open() fails, and says what to do.
CHECK_TEST(test_refusals)
{
  std::string port;
  for (const Case &one : cases()) {
    HapticServer server({ one.kind, "nothing=1" });
    port = server.port();
    Rig rig(one.make);
    const DriverError error = rig.refusal(server.device(one.device));
    fail_unless(error.kind == Kind::not_found, "%s", error.text.c_str());
    assert_contains(error.text, { "expected", "127.0.0.1" });
    const DriverError many = rig.refusal(server.device(one.device) + "x");
    assert_contains(many.text, { "expected" });
  }
  // Nobody is there.
  for (const Case &one : cases()) {
    Rig rig(one.make);
    const DriverError error = rig.refusal(std::string(one.device) + "@127.0.0.1:" + port);
    fail_unless(error.kind == Kind::not_found);
    assert_contains(error.text, { "cannot be reached", "start it", "docs/hardware/" });
    assert_contains(rig.refusal("x@host:0").text, { "NAME@HOST:PORT" });
  }
  HapticServer vest({ "bhaptics" });
  Rig rig(make_bhaptics_server);
  const DriverError error = rig.refusal(vest.device("vest-back"), 21);
  fail_unless(error.kind == Kind::settings);
  assert_contains(error.text, { "mapping needs 21 tactors", "it has 20" });
  // Only named devices are used.
  HapticServer intiface({ "buttplug4" });
  Rig unnamed(make_intiface_server);
  assert_contains(unnamed.refusal("@127.0.0.1:" + intiface.port()).text,
                  { "only named devices are used", "'Test Vibrator'", "'Mine'" });
  intiface.wait_for("gone");
  fail_unless(intiface.lines("motors").empty());
}

/// As in Totem. check runs each test in a process of its own.
CHECK_TEST(test_a_program_with_libsoup_2)
{
  fail_unless(dlopen("libsoup-2.4.so.1", RTLD_LAZY) != nullptr, "%s", dlerror());
  for (const Case &one : cases()) {
    const auto server = one.make(one.device);
    fail_if(server.has_value());
    assert_contains(server.error().text, { "this program's libsoup 2", "take another driver" });
  }
}

/// A server that answers nothing does not keep open() from being stopped.
CHECK_TEST(test_stopped_opening)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind, "silent=1" });
    Rig rig(one.make);
    DriverConfig config = rig.config(server.device(one.device));
    std::stop_source stop;
    config.stop = stop.get_token();
    const std::jthread stopper([&] {
      server.wait_for("got");
      stop.request_stop();
    });
    assert_contains(refusal_of(rig.driver.open(config)).text, { "stopped" });
  }
}

/// What one driver plays on no other gets, and the first one plays on.
CHECK_TEST(test_one_driver_a_device)
{
  for (const Case &one : cases()) {
    HapticServer server({ one.kind });
    Rig first(one.make);
    first.open(server.device(one.device));
    first.write({ 1.5 });
    server.wait_for_line(one.half);
    const std::size_t connections = server.lines("open").size();
    Rig second(one.make);
    const DriverError error = second.refusal(server.device(one.device));
    fail_unless(error.kind == Kind::busy);
    assert_contains(error.text,
                    { "another tactorsink of this program plays there", server.port().c_str() });
    ck_assert_uint_eq(server.lines("open").size(), connections); // it was not asked
    first.write({ 0 });
    server.wait_for_line(one.zero);
    first.driver.close();
    second.open(server.device(one.device));
  }
  // A suit's parts are devices of their own.
  HapticServer suit({ "bhaptics" });
  Rig back(make_bhaptics_server);
  back.open(suit.device("vest-back"));
  Rig front(make_bhaptics_server);
  front.open(suit.device("vest-front"));
  Rig both(make_bhaptics_server);
  assert_contains(both.refusal(suit.device("vest")).text, { "'VestBack', 'VestFront'" });
}

CHECK_TEST(test_registry)
{
  for (const char *name : { "bhaptics", "intiface" })
    fail_unless(make_driver(name).has_value());
}

CHECK_MAIN(server_driver)
