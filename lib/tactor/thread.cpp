// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/thread.h"

#include <cstring>
#include <string>
#include <utility>

namespace tactor {

tl::expected<Thread, DriverError>
Thread::start(std::function<void()> run)
{
  auto running = std::make_unique<Running>();
  running->run = std::move(run);
  const int error = pthread_create(
      &running->id, nullptr,
      [](void *data) -> void * {
        static_cast<Running *>(data)->run();
        return nullptr;
      },
      running.get());
  if (error != 0)
    return tl::unexpected(
        DriverError{ DriverError::Kind::failed,
                     std::string("no thread can be started for the board: ") + strerror(error)
                         + "; is a limit on threads too low (ulimit -u, TasksMax=)?" });
  Thread thread;
  thread.running_.reset(running.release());
  return thread;
}

void
Thread::Join::operator()(Running *running) const
{
  pthread_join(running->id, nullptr);
  delete running;
}

} // namespace tactor
