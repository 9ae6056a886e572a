// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gst/check/gstcheck.h>

/// haptic_server.py as a process of its own. It ends with this object.
class HapticServer
{
public:
  using Clock = std::chrono::steady_clock;

  /// `listener`, if any, gets each line as it comes, on a thread of its own.
  explicit HapticServer(std::vector<std::string> arguments,
                        std::function<void(const std::string &, Clock::time_point)> listener = {})
      : listener_(std::move(listener))
  {
    std::array<int, 2> in{};
    std::array<int, 2> out{};
    fail_unless(pipe2(in.data(), O_CLOEXEC) == 0 && pipe2(out.data(), O_CLOEXEC) == 0);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      std::string python = "/usr/bin/python3"; // the one that has Debian's websockets
      std::string script = HAPTIC_SERVER;
      std::vector<char *> words{ python.data(), script.data() };
      for (std::string &argument : arguments)
        words.push_back(argument.data());
      words.push_back(nullptr);
      execv(python.c_str(), words.data());
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    to_ = in[1];
    from_ = fdopen(out[0], "r");
    reader_ = std::thread([this] { read(); });
    port_ = wait_for("port ").substr(5);
  }
  ~HapticServer()
  {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    reader_.join();
    close(to_);
    fclose(from_);
  }
  HapticServer(const HapticServer &) = delete;
  HapticServer &operator=(const HapticServer &) = delete;

  const std::string &port() const
  {
    return port_;
  }
  /// Value of `device` for a device of this server.
  std::string device(const std::string &name) const
  {
    return name + "@127.0.0.1:" + port_;
  }

  /// Waits for a line that begins so, after those that were waited for before, and returns it. The
  /// end of the server fails the test.
  std::string wait_for(const std::string &begin)
  {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return next_ < lines_.size() || has_ended_; });
      fail_unless(next_ < lines_.size(), "the server ended before '%s'", begin.c_str());
      const std::string &line = lines_[next_++];
      if (line.starts_with(begin))
        return line;
    }
  }
  /// As wait_for(), for the whole line.
  void wait_for_line(const std::string &whole)
  {
    while (wait_for(whole) != whole)
      continue;
  }

  /// All lines so far that begin so.
  std::vector<std::string> lines(const std::string &begin)
  {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> some;
    for (const std::string &line : lines_)
      if (line.starts_with(begin))
        some.push_back(line);
    return some;
  }

  void say(const std::string &line) const
  {
    const std::string text = line + '\n';
    ck_assert_int_eq(::write(to_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

private:
  /// Reads what the server prints, which must not wait for the test. On a thread of its own.
  void read()
  {
    char *text = nullptr;
    std::size_t size = 0;
    while (getline(&text, &size, from_) > 0) {
      std::string line(text);
      while (!line.empty() && (line.back() == '\n' || line.back() == ' '))
        line.pop_back();
      if (listener_)
        listener_(line, Clock::now());
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
      changed_.notify_all();
    }
    free(text);
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    changed_.notify_all();
  }

  const std::function<void(const std::string &, Clock::time_point)> listener_;
  pid_t pid_ = -1;
  int to_ = -1;
  FILE *from_ = nullptr;
  std::string port_;
  std::thread reader_;
  std::mutex mutex_; ///< guards everything below
  std::condition_variable changed_;
  std::vector<std::string> lines_;
  std::size_t next_ = 0; ///< the first one that was not waited for
  bool has_ended_ = false;
};
