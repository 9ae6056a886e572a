// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>
#include <string>
#include <string_view>

/// The lines of WebVTT that its reader and the desk both read.
namespace tactile {

inline constexpr std::string_view kWebvttArrow = "-->";

/// "01:02:03.004", rounded down.
std::string write_webvtt_timestamp(Time time);

/// "00:00:01.000 --> 00:00:01.400"
std::string write_webvtt_timing(Time begin, Time end);

/// A cue's line of times. The end may be before the beginning.
struct WebvttTiming
{
  Time begin{ 0 };
  Time end{ 0 };
  std::string_view rest; ///< what follows the end in the line, such as settings
};

/// None if it is no such line, or a time is above 100 hours.
std::optional<WebvttTiming> read_webvtt_timing(std::string_view line);

/// The words of a note for tactile tracks; none: it is another note. `text` follows "NOTE".
std::optional<std::string_view> webvtt_tactile_note(std::string_view text);

/// Without spaces and tabs around it.
std::string_view webvtt_trimmed(std::string_view text);

} // namespace tactile
