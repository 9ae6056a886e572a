// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/driver_error.h"

#include <pthread.h>
#include <tl/expected.hpp>

#include <functional>
#include <memory>
#include <utility>

namespace tactor {

/// A thread that is joined when its object goes. std::thread throws where the system has no more
/// threads; this one says so.
class Thread
{
public:
  /// No thread.
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

  /// Runs `run` on a new thread. Fails where the limits of the user or of the system allow no more.
  [[nodiscard]] static tl::expected<Thread, DriverError> start(std::function<void()> run);

  /// Waits until `run` has returned. Does nothing where there is no thread.
  /// On the thread itself, which cannot wait for its own end, it only lets go of it.
  void join();

  /// Whether there is a thread that was not joined.
  explicit operator bool() const
  {
    return running_ != nullptr;
  }

  /// Whether the caller runs on this thread.
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

  std::shared_ptr<Running> running_; ///< also the thread's own
};

} // namespace tactor
