// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <limits>
#include <span>
#include <string>

namespace quality {

/// A running mean.
struct Mean
{
  double sum = 0;
  double count = 0;

  void add(double value)
  {
    sum += value;
    count += 1;
  }
  void add(const Mean &other)
  {
    sum += other.sum;
    count += other.count;
  }
  /// NaN if empty.
  double value() const
  {
    return sum / count;
  }
};

/// A mean with its 95 % interval; NaN where it is not known.
struct Estimate
{
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

/// The mean over all values of some units: pictures, films, spans of a film. Values within a unit
/// depend on one another, so units are drawn: percentile bootstrap (Efron 1979), 2000 draws with a
/// fixed seed. Fewer than two units with values have no interval.
Estimate estimate(std::span<const Mean> units);

/// "1.71 [1.61 1.81]", "–" for NaN.
std::string text(const Estimate &estimate, int digits);
/// "45.7 % [38.3 53.1]".
std::string percent_text(const Estimate &share);

} // namespace quality
