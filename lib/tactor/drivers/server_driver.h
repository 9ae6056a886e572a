// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/device_claim.h"
#include "tactor/drivers/server.h"
#include "tactor/drivers/threaded_driver.h"

#include <memory>
#include <optional>
#include <set>

namespace tactor {

class RealtimeThread;

/// Devices behind a server, such as a vest behind bHaptics Player.
///
/// open() loads the module, connects and queries the device. From then on a thread has server and
/// socket; write() leaves the newest levels to it. After a server has gone away or broken the
/// protocol, the thread connects again, at growing intervals. Levels are zero once write() was not
/// called for Settings::host_silence while one was on. A device that another driver of the process
/// has, also while it is lost, is refused.
class ServerDriver : public ThreadedDriver
{
public:
  struct Settings
  {
    Time answer = std::chrono::seconds(5); ///< for the connection to be open
    Time host_silence = std::chrono::milliseconds(250);
    Time refresh = std::chrono::milliseconds(80); ///< how often write() is called while one is on
    /// Pause before a lost server is searched for. Doubles up to the longest, and begins anew after
    /// a connection that lasted longer than that.
    Time look_again = std::chrono::seconds(1);
    Time longest_look_again = std::chrono::seconds(16);
    /// A server that sends more messages than these in a second is left.
    int most_messages = 1000;
  };

  explicit ServerDriver(MakeServer make_server);
  ServerDriver(MakeServer make_server, Settings settings);
  ~ServerDriver() override;

  Layout layout() const override;
  double resolution() const override;
  Time transport_latency() const override;
  Time longest_latency() const override;
  Time refresh_interval() const override;

private:
  struct Visit;

  // On the driver's thread. Those with a lock release it while they use the server.
  void run(Lock &lock) override;
  DriverError visit(Lock &lock, Server &server, RealtimeThread &realtime);
  void turn(Lock &lock, Visit &visit);
  void receive(Visit &visit, const SocketEvent &event, Time now);
  std::optional<DriverError> take(Lock &lock, const Server &server);
  void tell_refusal(Lock &lock, const DriverError &why);
  std::optional<Time> silent_at() const;

  void reset() override;
  void wake(Lock &lock) override;
  void levels_written() override;

  const MakeServer make_server_;
  const Settings settings_;

  // Guarded by the mutex
  MessageSocket *socket_ = nullptr; ///< to be woken
  ServedDevice device_;             ///< of the open driver
  Time latency_{ 0 };               ///< as measured last; kept while it is lost
  std::set<std::string> told_;      ///< why a server that is back is not used
};

} // namespace tactor
