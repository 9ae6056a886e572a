// SPDX-License-Identifier: LGPL-2.1-or-later
#include "follow/players/mpris_position.h"

#include "follow/position_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace follow {

namespace {

struct Unit
{
  const char *name;
  double nanoseconds;
};
constexpr std::array kUnits = {
  Unit{ "microseconds", 1e3 },
  Unit{ "milliseconds", 1e6 },
  Unit{ "nanoseconds", 1 },
};

/// A position that is renewed now and then goes by steps.
constexpr double kLeastSpeed = 0.5;
constexpr double kMostSpeed = 2;

} // namespace

std::optional<double>
MprisPosition::number(GVariant *value)
{
  switch (g_variant_classify(value)) {
  case G_VARIANT_CLASS_INT64:
    return static_cast<double>(g_variant_get_int64(value));
  case G_VARIANT_CLASS_UINT64:
    return static_cast<double>(g_variant_get_uint64(value));
  case G_VARIANT_CLASS_INT32:
    return g_variant_get_int32(value);
  case G_VARIANT_CLASS_UINT32:
    return g_variant_get_uint32(value);
  case G_VARIANT_CLASS_DOUBLE:
    return g_variant_get_double(value);
  default:
    return std::nullopt;
  }
}

const char *
MprisPosition::unit() const
{
  return kUnits.at(static_cast<std::size_t>(unit_)).name;
}

std::optional<Time>
MprisPosition::meant(std::optional<double> told) const
{
  constexpr auto kMost = static_cast<double>(PositionEstimator::kLongestFilm.count());
  const double nanoseconds
      = told.value_or(-1) * kUnits.at(static_cast<std::size_t>(unit_)).nanoseconds;
  if (!(nanoseconds >= 0 && nanoseconds <= kMost)) // nor is NaN one
    return std::nullopt;
  return Time(std::llround(nanoseconds));
}

void
MprisPosition::leap()
{
  mark_.reset();
  change_.reset();
  right_.reset();
  fault_.clear();
}

/// Selects the unit in which the position has advanced as fast as the film since the last
/// comparison.
void
MprisPosition::judge(double told, Time now, double rate)
{
  const double passed = rate * static_cast<double>((now - mark_->at).count());
  const auto fits = [&](const Unit &unit) {
    const double speed = (told - mark_->told) * unit.nanoseconds / passed;
    return speed >= kLeastSpeed && speed <= kMostSpeed;
  };
  const auto *const found = std::ranges::find_if(kUnits, fits);
  if (found == kUnits.end()) {
    if (now - mark_->at >= kPatience || told < mark_->told)
      mark_ = Mark{ now, told };
    return;
  }
  const auto candidate = static_cast<int>(found - kUnits.begin());
  if (candidate == candidate_ || candidate == unit_)
    unit_ = candidate;
  candidate_ = candidate;
  mark_ = Mark{ now, told };
  if (candidate == unit_) {
    right_ = now;
    fault_.clear();
  }
}

std::optional<Time>
MprisPosition::take(std::optional<double> told, Time now, double rate)
{
  const bool is_one = told && *told >= 0;
  if (is_one && !mark_)
    mark_ = Mark{ now, *told };
  if (!right_)
    right_ = now;
  if (is_one && (!change_ || change_->told != *told))
    change_ = Mark{ now, *told };
  if (is_one && now - mark_->at >= kLook)
    judge(*told, now, rate);
  if (now - *right_ >= kPatience)
    fault_ = !is_one                          ? "it reports none"
             : now - change_->at >= kPatience ? "it stays the same while the film plays"
                                              : "it does not go as the film plays";
  return meant(told);
}

} // namespace follow
