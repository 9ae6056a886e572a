// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/time.h"

#include <cstddef>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tactor {

/// What a sensor heard: any number of channels of one rate.
struct Recording
{
  /// No file may hold more numbers: three hours of one channel at 8 kHz.
  static constexpr std::size_t kMostValues = 100'000'000;

  double rate = 0; ///< samples per second
  Time start{ 0 }; ///< running time of the first sample
  double full_scale
      = 0; ///< where the sensor clips; 0: unknown, then its own extremes are looked at
  std::vector<std::vector<double>> channels{};

  std::size_t size() const
  {
    return channels.empty() ? 0 : channels.front().size();
  }
  /// The channel that hears a tactor: its own where there is one for each of `tactors`, else the
  /// only or the first one.
  int channel_of(int tactor, int tactors) const;
};

/// Reads a recording from a CSV file: a column of seconds, then one for each channel, separated by
/// commas, semicolons or tabs; lines that do not begin with a number (headers) are skipped. At most
/// 1 MHz, 28 hours, lines of 64 KiB. Uneven times are resampled to their mean rate. An error is a
/// line with file, line, what was expected and what came.
tl::expected<Recording, std::string> read_csv_recording(const std::string &path);

} // namespace tactor
