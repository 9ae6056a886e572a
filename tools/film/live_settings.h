// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "pipeline.h"

#include "chair/settings.h"
#include "chair/settings_watch.h"

#include <mutex>

/// Applies changes of the user's `intensity`, `mute` and `delay` to a sink of maps while it plays.
/// Options of the command line hold until the user changes that setting.
class LiveSettings
{
public:
  /// The values of the program's start. To be called first before the options are read, so that no
  /// change is missed.
  static const chair::Values &at_start();

  LiveSettings();

  /// Of the sink that plays from now on; null for none. It has the values of the start, or of
  /// options: what the user has changed since then is applied to it.
  void attach(GstElement *sink);

private:
  void apply();

  std::mutex mutex_;
  chair::Values now_;        ///< of live keys; guarded by the mutex
  chair::Values applied_;    ///< to the sink; guarded by the mutex
  Owned<GstElement> sink_{}; ///< guarded by the mutex
  chair::SettingsWatch watch_;
};
