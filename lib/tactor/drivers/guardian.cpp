// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/guardian.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <sched.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactor {

namespace {

/// The data of the process between this one and the guardian.
struct Start
{
  const char *program;
  char *const *arguments;
  const posix_spawn_file_actions_t *files;
  const posix_spawnattr_t *attributes;
  int error = 0; ///< errno
};

/// On a stack of its own in this process's memory, while the caller waits.
int
start_and_leave(void *data)
{
  auto &start = *static_cast<Start *>(data);
  pid_t guardian = 0;
  start.error = posix_spawn(&guardian, start.program, start.files, start.attributes,
                            start.arguments, environ);
  _exit(0); // the guardian's parent is init from now on
}

/// Starts a grandchild. The child does not signal its end, and wait() without __WCLONE does not see
/// it: the application may wait for children of its own. Returns an errno.
int
spawn(Start start)
{
  constexpr std::size_t kStack = 64 * 1024;
  const auto stack = std::make_unique<std::array<std::byte, kStack>>();
  const pid_t child
      = clone(start_and_leave, stack->data() + stack->size(), CLONE_VM | CLONE_VFORK, &start);
  if (child < 0)
    return errno;
  while (waitpid(child, nullptr, __WCLONE) < 0 && errno == EINTR) {
  }
  return start.error;
}

/// The guardian with `end` as its standard input, which is not closed here. Returns an errno.
int
spawn(const char *program, const std::string &bus_path, int end)
{
  std::array<std::string, 2> words{ program, bus_path };
  char *const arguments[] = { words[0].data(), words[1].data(), nullptr };
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  int error = posix_spawn_file_actions_adddup2(&files, end, STDIN_FILENO);
  for (const int output : { STDOUT_FILENO, STDERR_FILENO })
    error = error != 0 ? error
                       : posix_spawn_file_actions_addopen(&files, output, "/dev/null", O_WRONLY, 0);
  if (error == 0)
    error = posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  if (error == 0)
    error = spawn(
        { .program = program, .arguments = arguments, .files = &files, .attributes = &attributes });
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

} // namespace

tl::expected<Guardian, std::string>
Guardian::start(const std::string &bus_path)
{
  const char *set = secure_getenv("VISUOTACTILE_GUARDIAN");
  const char *program = set != nullptr ? set : GUARDIAN;
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return tl::unexpected(std::string("no socket: ") + std::strerror(errno));
  Guardian guardian(ends[0]);
  const int error = spawn(program, bus_path, ends[1]);
  close(ends[1]);
  if (error != 0)
    return tl::unexpected(std::string(program) + " cannot be run: " + std::strerror(error));
  return guardian;
}

Guardian::~Guardian()
{
  if (socket_ >= 0)
    close(socket_);
}

void
Guardian::dismiss()
{
  // A guardian that was killed costs no SIGPIPE.
  static_cast<void>(send(socket_, "", 1, MSG_NOSIGNAL));
}

} // namespace tactor
