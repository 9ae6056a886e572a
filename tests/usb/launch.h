// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <array>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <glib.h>

namespace usb_test {

/// A child process with the same emulated USB.
class Program
{
public:
  explicit Program(std::vector<std::string> words)
  {
    std::vector<char *> arguments;
    for (std::string &word : words)
      arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    std::array<int, 2> input{};
    if (pipe2(input.data(), O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe");
    input_ = input[1];
    posix_spawn_file_actions_adddup2(&files, input[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, fileno(errors_), STDERR_FILENO);
    // The test ignores SIGHUP, and its runner maybe others.
    sigset_t ignored;
    sigfillset(&ignored);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigdefault(&attributes, &ignored);
    const int error
        = posix_spawnp(&pid_, arguments[0], &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    close(input[0]);
    if (error != 0)
      throw std::runtime_error(words[0] + " cannot be run");
  }
  ~Program()
  {
    if (pid_ > 0)
      end(SIGKILL);
    if (input_ >= 0)
      close(input_);
    std::fclose(errors_);
  }
  Program(const Program &) = delete;
  Program &operator=(const Program &) = delete;

  void send(int signal)
  {
    kill(pid_, signal);
  }
  /// Writes a line to its standard input.
  void tell(const std::string &word)
  {
    if (dprintf(input_, "%s\n", word.c_str()) < 0)
      throw std::runtime_error("it does not listen");
  }
  /// Waits for the process. Returns the status of waitpid().
  int wait()
  {
    int status = 0;
    waitpid(std::exchange(pid_, -1), &status, 0);
    return status;
  }
  /// Ends its standard input.
  void leave()
  {
    close(std::exchange(input_, -1));
  }
  /// Sends a signal and waits for the process.
  int end(int signal)
  {
    send(signal);
    return wait();
  }
  /// What it has written to its standard error.
  std::string errors() const
  {
    std::string said;
    std::array<char, 4096> bytes{};
    for (ssize_t got = 0;
         (got = pread(fileno(errors_), bytes.data(), bytes.size(), static_cast<off_t>(said.size())))
         > 0;)
      said.append(bytes.data(), static_cast<std::size_t>(got));
    return said;
  }

private:
  std::FILE *const errors_ = std::tmpfile();
  int input_ = -1;
  pid_t pid_ = -1;
};

/// The words of a launch line after a program: `source`, which produces maps, and tactorsink.
inline std::vector<std::string>
launch_line(std::vector<std::string> words, const std::vector<std::string> &source,
            const std::vector<std::string> &properties)
{
  words.insert(words.end(), source.begin(), source.end());
  for (const char *word : { "!", "tactorsink", "max-on-time=0", "max-duty=0", "max-active=0" })
    words.emplace_back(word);
  words.insert(words.end(), properties.begin(), properties.end());
  return words;
}

/// Maps that turn nine motors on: 36 bytes of value 63 are nine floats of 0.747.
inline const std::vector<std::string> kNineMotors{
  "videotestsrc",
  "pattern=solid-color",
  "foreground-color=0xff373737",
  "!",
  "video/x-raw,format=GRAY8,width=36,height=1,framerate=30/1",
  "!",
  "capssetter",
  "replace=true",
  "join=false",
  "caps=application/x-tactile-map,rows=3,columns=3,framerate=30/1"
};

/// gst-launch-1.0 with tactorsink.
class Launch : public Program
{
public:
  /// Turns nine motors on. `options` of gst-launch-1.0, `properties` of tactorsink.
  explicit Launch(const std::vector<std::string> &options = {},
                  const std::vector<std::string> &properties = { "driver=firmata" })
      : Launch(kNineMotors, options, properties)
  {
  }
  /// `source` is a launch line that produces maps.
  Launch(const std::vector<std::string> &source, const std::vector<std::string> &options,
         const std::vector<std::string> &properties)
      : Program(launch_line(program(options), source, properties))
  {
  }

private:
  static std::vector<std::string> program(const std::vector<std::string> &options)
  {
    std::vector<std::string> words{ "gst-launch-1.0", "-q" };
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
};

/// bare_player, which has no handlers for signals.
class BarePlayer : public Program
{
public:
  explicit BarePlayer(const std::vector<std::string> &properties = { "driver=firmata" })
      : Program(launch_line({ g_getenv("BARE_PLAYER") }, kNineMotors, properties))
  {
  }
};

} // namespace usb_test
