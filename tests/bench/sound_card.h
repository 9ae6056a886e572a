// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

/// PulseAudio's null sink, in a server of its own, and what is heard of its left channel. The
/// monitor is read in pieces of 5 ms: times are that exact.
class SoundCard
{
public:
  /// `changed` gets the peak of a millisecond, 0 to 1, where it differs from the one before; on a
  /// thread of its own. Times are of the steady clock.
  explicit SoundCard(std::function<void(tactor::Time at, double level)> changed);
  ~SoundCard();
  SoundCard(const SoundCard &) = delete;
  SoundCard &operator=(const SoundCard &) = delete;

  /// For `pulsesink server=`.
  std::string server() const;

private:
  void listen();

  const std::function<void(tactor::Time, double)> changed_;
  const std::filesystem::path folder_;
  pid_t recorder_ = -1;
  FILE *heard_ = nullptr;
  std::thread listener_;
};
