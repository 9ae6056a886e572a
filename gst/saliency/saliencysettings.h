// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// saliencytactile's properties.
enum SaliencyProperty : guint
{
  SALIENCY_PROP_PROFILE = 1,
  SALIENCY_PROP_ROWS,
  SALIENCY_PROP_COLUMNS,
  SALIENCY_PROP_TEMPORAL,
  SALIENCY_PROP_THRESHOLD,
  SALIENCY_PROP_FLOOR,
  SALIENCY_PROP_ATTACH_SALIENCY,
  SALIENCY_PROP_MAX_RATE,
  SALIENCY_PROP_STATS,
};

enum class ProfileName
{
  tuned,
  paper,
};

/// What the user of saliencytactile sets, and how that looks as properties of a GObject. Not
/// thread-safe: the element guards it.
struct SaliencySettings
{
  /// A floor that is not set is the profile's own.
  static constexpr double kProfileFloor = -1;

  ProfileName profile = ProfileName::tuned;
  int rows = 3;
  int columns = 3;
  bool temporal = true;
  double threshold = 0.5;
  double floor = kProfileFloor;
  bool attach_saliency = false;
  double max_rate = 0;

  /// All of SaliencyProperty, with their texts, ranges and defaults.
  static void install(GObjectClass *klass);

  /// Sets or gets a property. False if it is none of these: SALIENCY_PROP_STATS is the element's
  /// own.
  bool set(guint id, const GValue *value);
  bool get(guint id, GValue *value) const;
};
