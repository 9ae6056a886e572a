// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include <gst/check/gstcheck.h>

/// haptic_server.py as a process of its own. It ends with this object.
class HapticServer
{
public:
  explicit HapticServer(std::vector<std::string> arguments)
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
    port_ = wait_for("port ").substr(5);
  }
  ~HapticServer()
  {
    close(to_);
    fclose(from_);
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
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

  /// Reads lines until one begins so, which is returned. The end of the server fails the test.
  std::string wait_for(const std::string &begin)
  {
    while (true) {
      std::array<char, 65536> buffer{};
      fail_unless(fgets(buffer.data(), buffer.size(), from_) != nullptr,
                  "the server ended before '%s'", begin.c_str());
      std::string line(buffer.data());
      while (!line.empty() && (line.back() == '\n' || line.back() == ' '))
        line.pop_back();
      lines_.push_back(line);
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

  /// Lines that were read so far and begin so.
  std::vector<std::string> lines(const std::string &begin) const
  {
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
  pid_t pid_ = -1;
  int to_ = -1;
  FILE *from_ = nullptr;
  std::string port_;
  std::vector<std::string> lines_;
};
