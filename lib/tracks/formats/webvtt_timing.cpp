// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/webvtt_timing.h"

#include "tracks/track.h"

#include <array>
#include <charconv>
#include <cstdio>

namespace tactile {

namespace {

/// Consumes exactly `digits` digits (0: any number up to 9).
bool
take_number(std::string_view &text, std::size_t digits, int &number)
{
  std::size_t count = 0;
  while (count < text.size() && count < 9 && text[count] >= '0' && text[count] <= '9')
    count++;
  if (count == 0 || (digits > 0 && count != digits))
    return false;
  std::from_chars(text.data(), text.data() + count, number);
  text.remove_prefix(count);
  return true;
}

bool
take_char(std::string_view &text, char expected)
{
  if (!text.starts_with(expected))
    return false;
  text.remove_prefix(1);
  return true;
}

/// Consumes [HH:]MM:SS.mmm; false if there is none.
bool
take_timestamp(std::string_view &text, Time &time)
{
  using namespace std::chrono;
  int first = 0;
  int second = 0;
  int third = -1;
  int fraction = 0;
  if (!take_number(text, 0, first) || !take_char(text, ':') || !take_number(text, 2, second))
    return false;
  if (take_char(text, ':') && !take_number(text, 2, third))
    return false;
  if (!take_char(text, '.') || !take_number(text, 3, fraction))
    return false;
  const bool has_hours = third >= 0;
  const int h = has_hours ? first : 0;
  const int m = has_hours ? second : first;
  const int s = has_hours ? third : second;
  if (h > 100 || m >= 60 || s >= 60) // before they are multiplied
    return false;
  time = hours(h) + minutes(m) + seconds(s) + milliseconds(fraction);
  return time <= Track::kMaxEnd;
}

} // namespace

std::string
write_webvtt_timestamp(Time time)
{
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  std::array<char, 48> text;
  std::snprintf(text.data(), text.size(), "%02d:%02d:%02d.%03d", static_cast<int>(ms / 3'600'000),
                static_cast<int>(ms / 60'000 % 60), static_cast<int>(ms / 1000 % 60),
                static_cast<int>(ms % 1000));
  return text.data();
}

std::string
write_webvtt_timing(Time begin, Time end)
{
  return write_webvtt_timestamp(begin) + " --> " + write_webvtt_timestamp(end);
}

std::optional<WebvttTiming>
read_webvtt_timing(std::string_view line)
{
  WebvttTiming timing;
  line = webvtt_trimmed(line);
  if (!take_timestamp(line, timing.begin))
    return std::nullopt;
  line = webvtt_trimmed(line);
  if (!line.starts_with(kWebvttArrow))
    return std::nullopt;
  line = webvtt_trimmed(line.substr(kWebvttArrow.size()));
  if (!take_timestamp(line, timing.end)
      || !(line.empty() || line.front() == ' ' || line.front() == '\t'))
    return std::nullopt;
  timing.rest = line;
  return timing;
}

std::optional<std::string_view>
webvtt_tactile_note(std::string_view text)
{
  constexpr std::string_view kWord = "tactile";
  text = webvtt_trimmed(text);
  if (text != kWord && !text.starts_with(std::string(kWord) + " "))
    return std::nullopt;
  return text.substr(kWord.size());
}

std::string_view
webvtt_trimmed(std::string_view text)
{
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
    text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t'))
    text.remove_suffix(1);
  return text;
}

} // namespace tactile
