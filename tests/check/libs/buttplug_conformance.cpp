// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The five sequences of Buttplug's own client conformance test, as its documentation describes them
// (github.com/buttplugio/buttplug, crates/buttplug_client_conformance_test, README and
// docs/test-sequences.md): core_protocol, ping_required, error_handling, ping_timeout and
// reconnection. Its program is built from source by cargo and is not packaged; a server of ours
// (support/haptic_server.py) has its three devices.
//
// This client vibrates what the user has named, and nothing else. So it sends no StartScanning,
// which starts whatever is near, no other OutputCmd than Vibrate, no InputCmd, and a StopCmd for
// its own devices alone.
#include "tactor/drivers/server_driver.h"

#include "support/contains.h"
#include "support/haptic_server.h"
#include "support/unwrap.h"

#include <csignal>

#include <condition_variable>
#include <memory>
#include <mutex>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using EventKind = DriverEvent::Kind;

namespace {

const char *const kVibrator = "Conformance Test Vibrator";

std::vector<std::string>
conforming(std::vector<std::string> options = {})
{
  options.insert(options.begin(), { "buttplug4", "conformance=1" });
  return options;
}

/// A client that plays on the vibrator, and looks for a lost server at once.
struct Client
{
  explicit Client(const HapticServer &server)
  {
    unwrap(driver.open(
        { .device = server.device(kVibrator), .notify = [this](const DriverEvent &event) {
           const std::lock_guard lock(mutex);
           events.push_back(event.kind);
           changed.notify_all();
         } }));
  }
  void write(std::initializer_list<double> volts)
  {
    unwrap(driver.write(std::vector(volts), 0s));
  }
  void wait_for(EventKind kind)
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return std::ranges::find(events, kind) != events.end(); });
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<EventKind> events;
  ServerDriver driver{
    make_intiface_server,
    { .answer = 30s, .host_silence = 1h, .look_again = 1ms, .longest_look_again = 2ms }
  };
};

/// The messages that the server got are of these kinds, in this order; `Ping` is left out.
void
assert_kinds(HapticServer &server, const std::vector<std::string> &expected)
{
  std::vector<std::string> kinds;
  for (const std::string &line : server.lines("got [{\"")) {
    const std::string rest = line.substr(std::string("got [{\"").size());
    if (!rest.starts_with("Ping\""))
      kinds.push_back(rest.substr(0, rest.find('"')));
  }
  ck_assert_uint_ge(kinds.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); i++)
    assert_text(kinds[i], expected[i]);
}

const std::vector<std::string> kHandshake{ "RequestServerInfo", "RequestDeviceList", "StopCmd" };

} // namespace

/// Handshake, devices, commands, stop, a device that goes.
CHECK_TEST(test_core_protocol)
{
  HapticServer server(conforming());
  {
    Client client(server);
    ck_assert_int_eq(client.driver.tactors(), 2); // Vibrate twice; its Rotate is none
    server.wait_for_line("got [{\"RequestServerInfo\":{\"Id\":1,\"ClientName\":\"visuotactile\","
                         "\"ProtocolVersionMajor\":4,\"ProtocolVersionMinor\":0}}]");
    assert_kinds(server, kHandshake);
    client.write({ 1.5, 3 });
    server.wait_for_line("motors 0 0=50 1=100");
    client.write({ 0, 3 });
    server.wait_for_line("motors 0 1=100");
    server.say("remove");
    client.wait_for(EventKind::lost);
    server.wait_for("gone");
    server.say("add");
    client.wait_for(EventKind::returned);
    server.wait_for_line("motors 0 1=100");
    client.driver.close();
    server.wait_for_line("motors 0");
    server.wait_for("gone");
  }
  // Nothing was asked of the others.
  for (const char *never : { "\"DeviceIndex\":1", "\"DeviceIndex\":2", "StartScanning" })
    for (const std::string &line : server.lines("got"))
      fail_if(line.find(never) != std::string::npos, "%s", line.c_str());
}

/// A server that asks for pings, and breaks off without them.
CHECK_TEST(test_ping_required)
{
  HapticServer server(conforming({ "ping=1000", "enforces=1" }));
  Client client(server);
  for (int i = 1; i <= 4; i++) {
    server.wait_for("got [{\"Ping\"");
    client.write({ 0.3 * i });
    server.wait_for_line("motors 0 0=" + std::to_string(10 * i));
  }
  fail_unless(server.lines("unpinged").empty());
}

/// An error is no reason to leave: valid commands follow.
CHECK_TEST(test_error_handling)
{
  HapticServer server(conforming({ "errs=2" })); // the first one stops the device
  Client client(server);
  client.write({ 1.5 });
  server.wait_for("got [{\"OutputCmd\"");
  client.wait_for(EventKind::warning);
  client.write({ 3 });
  server.wait_for_line("motors 0 0=100");
  fail_unless(server.lines("gone").empty());
  fail_unless(client.driver.status().is_there);
}

/// A client that stands still sends no pings: the server stops the device and leaves. The client
/// notices when it goes on.
CHECK_TEST(test_ping_timeout)
{
  HapticServer server(conforming({ "ping=500", "enforces=1" }));
  const pid_t child = fork();
  if (child == 0) {
    Client client(server);
    client.write({ 1.5 });
    client.wait_for(EventKind::lost);
    client.wait_for(EventKind::returned);
    while (true)
      pause();
  }
  server.wait_for_line("motors 0 0=50");
  kill(child, SIGSTOP);
  server.wait_for("unpinged");
  server.wait_for_line("motors 0");
  server.wait_for("gone");
  kill(child, SIGCONT);
  server.wait_for("open");
  server.wait_for("got [{\"RequestServerInfo\"");
  server.wait_for_line("motors 0 0=50");
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

/// A server that goes and comes back at the same port is greeted anew, and its devices are read
/// anew.
CHECK_TEST(test_reconnection)
{
  auto server = std::make_unique<HapticServer>(conforming());
  const std::string port = server->port();
  Client client(*server);
  client.write({ 1.5 });
  server->wait_for_line("motors 0 0=50");
  server.reset();
  client.wait_for(EventKind::lost);
  fail_if(client.driver.status().is_there);
  server = std::make_unique<HapticServer>(conforming({ "port=" + port }));
  client.wait_for(EventKind::returned);
  server->wait_for_line("motors 0 0=50");
  assert_kinds(*server, kHandshake);
  client.write({ 3 });
  server->wait_for_line("motors 0 0=100");
}

CHECK_MAIN(buttplug_conformance)
