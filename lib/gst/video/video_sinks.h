// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib.h>

/// The DirectFB sink of GStreamer 1.22 crashes on the change to READY if there is no frame buffer.
/// Code that tries video sinks in turn must skip it.
inline constexpr const gchar *kCrashingVideoSink = "dfbvideosink";
