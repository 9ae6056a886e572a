// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What all drivers with a thread have: here with a device that does nothing.
#include "tactor/drivers/threaded_driver.h"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"
#include "support/contains.h"
#include "support/unwrap.h"

using namespace tactor;

namespace {

class Device final : public ThreadedDriver
{
public:
  ~Device() override
  {
    close();
  }
  double resolution() const override
  {
    return 0;
  }
  Time transport_latency() const override
  {
    return Time(0);
  }

  std::atomic<bool> hangs{ false }; ///< with the lock
  std::atomic<bool> is_hanging{ false };

private:
  void run(Lock &lock) override
  {
    tactors_ = 1;
    status_.board = "the device";
    opened();
    changed_.wait(lock, [this] { return quit_ || hangs; });
    is_hanging = hangs.load();
    while (hangs)
      std::this_thread::yield();
  }
  void reset() override
  {
  }
  void levels_written() override
  {
    changed_.notify_all();
  }
};

} // namespace

/// A thread that has the mutex for ever, as while a file of a home folder cannot be read, does not
/// keep a signal from ending the process.
CHECK_TEST(test_mutex_is_kept)
{
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGTERM, SIG_DFL);
    Device device;
    if (!device.open({}))
      std::_Exit(1);
    device.hangs = true;
    if (!device.write(std::vector<double>{ 1 }, Time(0)))
      std::_Exit(2);
    while (!device.is_hanging)
      std::this_thread::yield();
    raise(SIGTERM);
    for (;;)
      pause();
  }
  int status = 0;
  fail_unless(waitpid(child, &status, 0) == child);
  fail_unless(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM, "status %d", status);
}

/// The application handles the signal only once the device was released: write() says that nothing
/// is felt any more.
CHECK_TEST(test_application_goes_on)
{
  std::signal(SIGUSR2, SIG_DFL);
  Device device;
  unwrap(device.open({}));
  unwrap(device.write(std::vector<double>{ 1 }, Time(0)));
  const TerminationGuard application([](auto) { std::signal(SIGUSR2, [](int) {}); });
  raise(SIGUSR2);
  tl::expected<void, DriverError> written;
  while ((written = device.write(std::vector<double>{ 1 }, Time(0))))
    std::this_thread::yield();
  assert_contains(written.error().text, { "the device", "released", "signal", "play it again" });
  fail_if(device.status().is_there);
  unwrap(device.open({}));
  unwrap(device.write(std::vector<double>{ 1 }, Time(0)));
}

CHECK_MAIN(threaded_driver)
