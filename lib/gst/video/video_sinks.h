// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

/// GStreamer 1.22's DirectFB sink: without a frame buffer its change to READY crashes the process.
/// Whoever tries video sinks in turn has to leave it out.
inline constexpr const gchar *kCrashingVideoSink = "dfbvideosink";
