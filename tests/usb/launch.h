// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <csignal>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace usb_test {

/// gst-launch-1.0 as a child process, with the same emulated USB.
class Launch
{
public:
  /// Turns nine motors on. `options` of gst-launch-1.0, `properties` of tactorsink.
  explicit Launch(const std::vector<std::string> &options = {},
                  const std::vector<std::string> &properties = { "driver=firmata" })
      // 36 bytes of value 63 are a map of nine floats of 0.747.
      : Launch({ "videotestsrc", "pattern=solid-color", "foreground-color=0xff373737", "!",
                 "video/x-raw,format=GRAY8,width=36,height=1,framerate=30/1", "!", "capssetter",
                 "replace=true", "join=false",
                 "caps=application/x-tactile-map,rows=3,columns=3,framerate=30/1" },
               options, properties)
  {
  }
  /// `source` is a launch line that produces maps.
  Launch(const std::vector<std::string> &source, const std::vector<std::string> &options,
         const std::vector<std::string> &properties)
  {
    std::vector<std::string> words{ "gst-launch-1.0", "-q" };
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), source.begin(), source.end());
    for (const char *word : { "!", "tactorsink", "max-on-time=0", "max-duty=0", "max-active=0" })
      words.emplace_back(word);
    words.insert(words.end(), properties.begin(), properties.end());
    std::vector<char *> arguments;
    for (std::string &word : words)
      arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawnp(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0)
      throw std::runtime_error("gst-launch-1.0 cannot be run");
  }
  ~Launch()
  {
    if (pid_ > 0)
      end(SIGKILL);
  }
  Launch(const Launch &) = delete;
  Launch &operator=(const Launch &) = delete;

  void send(int signal)
  {
    kill(pid_, signal);
  }
  /// Sends a signal and waits for the process. Returns the status of waitpid().
  int end(int signal)
  {
    int status = 0;
    kill(pid_, signal);
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return status;
  }

private:
  pid_t pid_ = -1;
};

} // namespace usb_test
