// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

// Comparisons of real numbers, which GStreamer's copy of check lacks. NaN fails both.

#include <gst/check/gstcheck.h>

#include <cmath>

#define fail_unless_at_most(value, bound)                                                          \
  do {                                                                                             \
    const double value_ = (value);                                                                 \
    const double bound_ = (bound);                                                                 \
    fail_unless(value_ <= bound_, "%s is %.9g, more than %.9g", #value, value_, bound_);           \
  } while (0)

#define fail_unless_near(value, expected, tolerance)                                               \
  do {                                                                                             \
    const double value_ = static_cast<double>(value);                                              \
    const double expected_ = static_cast<double>(expected);                                        \
    fail_unless(std::abs(value_ - expected_) <= (tolerance), "%s is %.9g, not %.9g", #value,       \
                value_, expected_);                                                                \
  } while (0)
