// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <optional>
#include <string>
#include <string_view>

/// Seconds by which a key moves the film, as in mpv: Left and Right 10 s, Down and Up a minute.
std::optional<int> seek_of(std::string_view key);

/// Handles a key for the analysis or the motors' sink: plus and minus change the intensity, M
/// mutes, 1 and 2 change the sensitivity, 3 and 4 the density. Returns the new value as a line for
/// the user, empty for another key. Keys have X11's names.
std::string turn(std::string_view key, GstElement *analysis, GstElement *chair);

/// Whether a key changes how events are found, so that the meter is to be shown.
bool is_steering(std::string_view key);

/// 1:02:03 or 2:03
std::string clock_time(GstClockTime time);
