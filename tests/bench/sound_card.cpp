// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound_card.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;
using tactor::Time;

namespace {

constexpr int kPerMillisecond = 48;
/// The null sink renders this much at once, when it is about to be heard.
constexpr Time kRendered = 5ms;
constexpr double kSilent = 0.01;
constexpr double kStep = 0.001; ///< the least change that is told

std::filesystem::path
make_folder()
{
  std::string path = std::filesystem::temp_directory_path() / "sound-card-XXXXXX";
  fail_unless(mkdtemp(path.data()) != nullptr);
  return path;
}

/// Starts a program, its standard output at `out`.
pid_t
start(std::vector<std::string> words, int out = STDOUT_FILENO)
{
  const pid_t pid = fork();
  if (pid != 0)
    return pid;
  std::vector<char *> arguments;
  for (std::string &word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  dup2(out, STDOUT_FILENO);
  execvp(arguments.front(), arguments.data());
  _exit(127);
}

/// Whether a program ends well.
bool
runs(std::vector<std::string> words)
{
  int status = 0;
  return waitpid(start(std::move(words)), &status, 0) > 0 && WIFEXITED(status)
         && WEXITSTATUS(status) == 0;
}

} // namespace

SoundCard::SoundCard(std::function<void(Time, double)> changed)
    : changed_(std::move(changed)), folder_(make_folder())
{
  // It is ready when its parent has ended. Its own start fails under umockdev-wrapper.
  fail_unless(runs({ "env", "-u", "LD_PRELOAD", "pulseaudio", "-n", "--daemonize=yes",
                     "--exit-idle-time=-1", "--use-pid-file=no", "--log-level=error",
                     "--realtime=no", "--load=module-null-sink sink_name=null rate=48000",
                     "--load=module-native-protocol-unix socket=" + (folder_ / "socket").string()
                         + " auth-anonymous=1" }),
              "PulseAudio does not start: expected the Debian package pulseaudio");
  std::array<int, 2> ends{};
  fail_unless(pipe2(ends.data(), O_CLOEXEC) == 0);
  recorder_ = start({ "parec", "--server=" + server(), "--raw", "--format=s16le", "--rate=48000",
                      "--channels=2", "--latency-msec=5", "--device=null.monitor" },
                    ends[1]);
  close(ends[1]);
  heard_ = fdopen(ends[0], "r");
  // The monitor is heard before anything plays.
  fail_unless(std::fgetc(heard_) != EOF, "parec hears nothing");
  std::fgetc(heard_);
  std::fgetc(heard_);
  std::fgetc(heard_);
  listener_ = std::thread([this] { listen(); });
}

SoundCard::~SoundCard()
{
  kill(recorder_, SIGKILL);
  waitpid(recorder_, nullptr, 0);
  listener_.join();
  std::fclose(heard_);
  runs({ "pactl", "--server=" + server(), "exit" });
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string
SoundCard::server() const
{
  return "unix:" + (folder_ / "socket").string();
}

void
SoundCard::listen()
{
  std::setvbuf(heard_, nullptr, _IONBF, 0);
  std::array<std::array<std::int16_t, 2>, kPerMillisecond> frames{};
  Time begin = Time::max(); ///< of the first piece; found by those that came with the least delay
  double last = 0;
  for (std::int64_t piece = 0; std::fread(frames.data(), sizeof frames, 1, heard_) == 1; piece++) {
    const Time now = std::chrono::steady_clock::now().time_since_epoch();
    begin = std::min(begin, now + kRendered - (piece + 1) * Time(1ms));
    double peak = 0;
    for (const auto &[left, right] : frames)
      peak = std::max(peak, std::abs(left / 32767.0));
    if (peak < kSilent)
      peak = 0;
    if (std::abs(peak - last) >= kStep || (peak == 0) != (last == 0)) {
      changed_(begin + piece * Time(1ms), peak);
      last = peak;
    }
  }
}
