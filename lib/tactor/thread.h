// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"

#include <pthread.h>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <utility>

namespace tactor {

/// A thread that is joined by its destructor and blocks signals, but for faults. Unlike
/// std::thread it returns an error where the system has no more threads.
class Thread
{
public:
  Thread() = default;
  ~Thread()
  {
    join();
  }
  Thread(Thread &&) = default;
  Thread &operator=(Thread &&other)
  {
    join();
    running_ = std::move(other.running_);
    return *this;
  }

  /// Runs `run` on a new thread. Fails where the limits of the user or the system allow no more.
  [[nodiscard]] static tl::expected<Thread, DriverError> start(std::function<void()> run);

  /// Waits until `run` has returned. Without a thread it does nothing; on the thread itself it
  /// detaches.
  void join();

  /// Whether there is a thread to join.
  explicit operator bool() const
  {
    return running_ != nullptr;
  }

  bool is_current() const
  {
    return running_ && pthread_equal(running_->id, pthread_self()) != 0;
  }

private:
  struct Running
  {
    std::function<void()> run;
    pthread_t id{};
  };

  std::shared_ptr<Running> running_; ///< shared with the thread
};

} // namespace tactor
