// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/thread.h"

#include <csignal>
#include <cstring>
#include <string>
#include <utility>

namespace tactor {

tl::expected<Thread, DriverError>
Thread::start(std::function<void()> run)
{
  Thread thread;
  thread.running_ = std::make_shared<Running>();
  thread.running_->run = std::move(run);
  auto own = std::make_unique<std::shared_ptr<Running>>(thread.running_);
  // Signals are for the application's threads. Faults are handled where they happen.
  sigset_t blocked;
  sigset_t before;
  sigfillset(&blocked);
  for (const int fault : { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT })
    sigdelset(&blocked, fault);
  pthread_sigmask(SIG_SETMASK, &blocked, &before);
  const int error = pthread_create(
      &thread.running_->id, nullptr,
      [](void *data) -> void * {
        const std::unique_ptr<std::shared_ptr<Running>> running(
            static_cast<std::shared_ptr<Running> *>(data));
        (*running)->run();
        return nullptr;
      },
      own.get());
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (error == 0) {
    static_cast<void>(own.release());
    return thread;
  }
  thread.running_.reset();
  return tl::unexpected(
      DriverError{ DriverError::Kind::failed,
                   std::string("no thread can be started for the board: ") + strerror(error)
                       + "; is a limit on threads too low (ulimit -u, TasksMax=)?" });
}

void
Thread::join()
{
  const std::shared_ptr<Running> running = std::move(running_);
  if (!running)
    return;
  if (pthread_equal(running->id, pthread_self()) != 0)
    pthread_detach(running->id);
  else
    pthread_join(running->id, nullptr);
}

} // namespace tactor
