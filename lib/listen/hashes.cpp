// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/hashes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace listen {

namespace {

constexpr double kStep = 2;      ///< bins and frames of a unit
constexpr double kNearest = 2;   ///< frames between the peaks
constexpr double kFarthest = 62; ///< frames: a second
constexpr double kWidest = 126;  ///< bins
constexpr std::size_t kPartners = 4;
constexpr std::size_t kHeardPartners = 20;
constexpr double kUnsure = 0.3; ///< units: values so near to the middle of two units count as both

std::uint32_t
value_of(int first, int step, int wait)
{
  return static_cast<std::uint32_t>(first) << 12U | static_cast<std::uint32_t>(step + 64) << 5U
         | static_cast<std::uint32_t>(wait);
}

/// A distance, rounded to the nearest unit and to the next nearest.
struct Units
{
  int nearest;
  int next; ///< `nearest` unless within kUnsure
};

Units
units(double distance)
{
  const double whole = distance / kStep;
  const int nearest = static_cast<int>(std::lround(whole));
  const double off = whole - nearest;
  return { .nearest = nearest,
           .next = std::abs(off) > 0.5 - kUnsure ? nearest + (off > 0 ? 1 : -1) : nearest };
}

bool
is_value(int first, int step, int wait)
{
  return first >= 0 && first < 128 && step >= -63 && step < 64 && wait >= 1 && wait < 32;
}

} // namespace

std::vector<Hash>
film_hashes(std::span<const Peak> peaks)
{
  std::vector<Hash> hashes;
  std::vector<const Peak *> partners;
  for (std::size_t i = 0; i < peaks.size(); i++) {
    const Peak &first = peaks[i];
    partners.clear();
    for (std::size_t j = i + 1; j < peaks.size(); j++) {
      const auto wait = static_cast<double>(peaks[j].frame - first.frame);
      if (wait > kFarthest)
        break;
      if (wait >= kNearest && std::abs(peaks[j].bin - first.bin) <= kWidest)
        partners.push_back(&peaks[j]);
    }
    const auto end
        = partners.begin() + static_cast<std::ptrdiff_t>(std::min(kPartners, partners.size()));
    std::ranges::partial_sort(partners, end, std::ranges::greater(), &Peak::strength);
    for (auto partner = partners.begin(); partner != end; ++partner) {
      const int at = units(first.bin).nearest;
      const int step = units((*partner)->bin - first.bin).nearest;
      const int wait = units(static_cast<double>((*partner)->frame - first.frame)).nearest;
      if (is_value(at, step, wait))
        hashes.push_back({ .frame = first.frame,
                           .value = value_of(at, step, wait),
                           .strength = std::min(first.strength, (*partner)->strength) });
    }
  }
  return hashes;
}

std::vector<Hash>
heard_hashes(std::span<const Peak> peaks, double rate)
{
  std::vector<Hash> hashes;
  std::ptrdiff_t begin = 0; // of this frame's
  for (std::size_t i = 0; i < peaks.size(); i++) {
    const Peak &first = peaks[i];
    const Units at = units(first.bin / rate);
    const std::int64_t frame = std::llround(static_cast<double>(first.frame) * rate);
    std::size_t partners = 0;
    for (std::size_t j = i + 1; j < peaks.size() && partners < kHeardPartners; j++) {
      const double wait = static_cast<double>(peaks[j].frame - first.frame) * rate;
      const double step = (peaks[j].bin - first.bin) / rate;
      if (wait > kFarthest)
        break;
      if (wait < kNearest || std::abs(step) > kWidest)
        continue;
      partners++;
      const Units steps = units(step);
      const Units waits = units(wait);
      const auto add = [&](int a, int s, int w) {
        if (is_value(a, s, w))
          hashes.push_back({ .frame = frame,
                             .value = value_of(a, s, w),
                             .strength = std::min(first.strength, peaks[j].strength) });
      };
      add(at.nearest, steps.nearest, waits.nearest);
      add(at.next, steps.nearest, waits.nearest);
      add(at.nearest, steps.next, waits.nearest);
      add(at.nearest, steps.nearest, waits.next);
    }
    if (i + 1 < peaks.size() && peaks[i + 1].frame == first.frame)
      continue;
    const auto of_frame = std::ranges::subrange(hashes.begin() + begin, hashes.end());
    std::ranges::sort(of_frame, {}, &Hash::value);
    hashes.erase(std::ranges::unique(of_frame, {}, &Hash::value).begin(), hashes.end());
    begin = std::ssize(hashes);
  }
  return hashes;
}

} // namespace listen
