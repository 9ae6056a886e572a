// SPDX-License-Identifier: LGPL-2.1-or-later
#include "program.h"
#include "translation.h"

#include <glib.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <memory>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

std::atomic<pid_t> the_child{ 0 };
std::atomic<bool> was_stopped{ false };

void
stop(int)
{
  was_stopped = true;
  if (const pid_t child = the_child; child > 0)
    kill(child, SIGTERM);
}

constexpr std::array kSignals = { SIGINT, SIGTERM, SIGHUP };
using Actions = std::array<struct sigaction, kSignals.size()>;
Actions the_actions_before{};
int the_depth = 0;

bool
is_ignored(const struct sigaction &action)
{
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_IGN;
}

class FileDescriptor
{
public:
  explicit FileDescriptor(int number) : number_(number)
  {
  }
  ~FileDescriptor()
  {
    close(number_);
  }
  FileDescriptor(const FileDescriptor &) = delete;
  FileDescriptor &operator=(const FileDescriptor &) = delete;
  int operator*() const
  {
    return number_;
  }

private:
  int number_;
};

/// In the child, before it becomes the other program. GLib has reset its signals.
void
prepare_child(gpointer)
{
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (std::size_t i = 0; i < kSignals.size(); i++)
    if (is_ignored(the_actions_before[i]))
      signal(kSignals[i], SIG_IGN);
}

/// Calls for each line up to the end of the stream. mkvmerge ends lines of progress with \r.
void
read_lines(int from, const std::function<void(std::string_view)> &on_line)
{
  std::string held;
  std::array<char, 65536> piece;
  for (;;) {
    const ssize_t count = read(from, piece.data(), piece.size());
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      break;
    held.append(piece.data(), static_cast<std::size_t>(count));
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = held.find_first_of("\r\n", begin)) != std::string::npos;
         begin = end + 1)
      on_line(std::string_view(held).substr(begin, end - begin));
    held.erase(0, begin);
  }
  if (!held.empty())
    on_line(held);
}

std::string
last_line(int file)
{
  constexpr off_t kMost = 4096;
  const off_t size = lseek(file, 0, SEEK_END);
  std::string text(static_cast<std::size_t>(std::min(std::max<off_t>(size, 0), kMost)), '\0');
  const ssize_t count = pread(file, text.data(), text.size(), std::max<off_t>(size - kMost, 0));
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.find_last_of("\r\n") + 1);
}

} // namespace

SignalsStop::SignalsStop()
{
  if (the_depth++ > 0)
    return;
  was_stopped = false;
  struct sigaction action = {};
  action.sa_handler = stop; // without SA_RESTART: read() returns
  for (std::size_t i = 0; i < kSignals.size(); i++) {
    sigaction(kSignals[i], nullptr, &the_actions_before[i]);
    if (!is_ignored(the_actions_before[i]))
      sigaction(kSignals[i], &action, nullptr);
  }
}

SignalsStop::~SignalsStop()
{
  if (--the_depth > 0)
    return;
  for (std::size_t i = 0; i < kSignals.size(); i++)
    sigaction(kSignals[i], &the_actions_before[i], nullptr);
}

void
signals_stop_here()
{
  if (was_stopped)
    throw Stopped();
}

ProgramEnd
run_program(const std::vector<std::string> &arguments, const char *package,
            const std::function<void(std::string_view)> &on_line)
{
  std::vector<const gchar *> argv;
  for (const std::string &argument : arguments)
    argv.push_back(argument.c_str());
  argv.push_back(nullptr);
  g_auto(GStrv) environment = g_environ_setenv(g_get_environ(), "LC_ALL", "C.UTF-8", TRUE);
  const FileDescriptor errors(memfd_create("stderr", MFD_CLOEXEC));
  std::array<int, 2> ends{};
  if (*errors < 0 || pipe(ends.data()) != 0)
    throw std::runtime_error(in_text("cannot start {}: {}", argv[0], g_strerror(errno)));
  const FileDescriptor from(ends[0]);
  auto to = std::make_unique<FileDescriptor>(ends[1]);

  const SignalsStop signals_stop;
  signals_stop_here();
  GPid child = 0;
  g_autoptr(GError) error = nullptr;
  if (!g_spawn_async_with_fds(
          nullptr, const_cast<gchar **>(argv.data()), environment,
          static_cast<GSpawnFlags>(G_SPAWN_SEARCH_PATH | G_SPAWN_DO_NOT_REAP_CHILD), prepare_child,
          nullptr, &child, -1, **to, *errors, &error))
    throw std::runtime_error(in_text("'{}' is needed: {}", argv[0],
                                     (g_error_matches(error, G_SPAWN_ERROR, G_SPAWN_ERROR_NOENT)
                                          ? std::string("install the package ") + package
                                          : error->message)));
  the_child = child;
  if (was_stopped)
    kill(child, SIGTERM);
  to.reset();
  read_lines(*from, on_line);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  the_child = 0;
  signals_stop_here();
  return { .status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
           .complaint = last_line(*errors) };
}
