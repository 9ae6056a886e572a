// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <cstddef>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// A sensor recording: any number of channels at one rate.
struct Recording
{
  /// Limit on the size of a file: three hours of one channel at 8 kHz.
  static constexpr std::size_t kMostValues = 100'000'000;

  double rate = 0;       ///< samples per second
  Time start{ 0 };       ///< running time of the first sample
  double full_scale = 0; ///< where the sensor clips; 0: unknown, the largest sample is taken
  std::vector<std::vector<double>> channels{};

  std::size_t size() const
  {
    return channels.empty() ? 0 : channels.front().size();
  }
  /// The channel for a tactor: its own if there is one for each of `tactors`, else the first.
  int channel_of(int tactor, int tactors) const;
};

/// Reads a recording from a CSV file: a column of seconds, then one per channel, separated by
/// commas, semicolons or tabs. Lines that do not start with a number (headers) are skipped. Limits:
/// 1 MHz, 28 hours, lines of 64 KiB. Unevenly spaced samples are resampled to their mean rate. An
/// error is one line with file, line, what was expected and what was found.
tl::expected<Recording, std::string> read_csv_recording(const std::string &path);

} // namespace tactor
