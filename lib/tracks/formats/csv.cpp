// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks/formats/csv.h"

#include "text.h"
#include "tracks/formats/line_reader.h"
#include "tracks/text_cue.h"

#include <array>
#include <charconv>
#include <utility>
#include <vector>

namespace tactile {

namespace {

constexpr Time::rep kNsPerMs = 1'000'000;

template <typename Number>
void
append_number(std::string &text, Number number)
{
  std::array<char, 64> digits;
  if constexpr (std::is_floating_point_v<Number>)
    text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number,
                                             std::chars_format::fixed)
                                   .ptr);
  else
    text.append(digits.data(),
                std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
}

void
append_line(std::string &text, Time time, const TactileMap &map, bool has_frequency)
{
  append_number(text, time.count() / kNsPerMs);
  if (const Time::rep ns = time.count() % kNsPerMs; ns != 0) {
    std::string decimals = std::to_string(kNsPerMs + ns).substr(1);
    decimals.erase(decimals.find_last_not_of('0') + 1);
    text += "." + decimals;
  }
  for (const float level : map.levels) {
    text += ',';
    append_number(text, level);
  }
  if (has_frequency) {
    text += ',';
    append_number(text, map.frequency);
  }
  text += '\n';
}

std::string_view
take_field(std::string_view &line)
{
  const std::size_t length = line.find(',');
  std::string_view field = line.substr(0, length);
  line.remove_prefix(length == std::string_view::npos ? line.size() : length + 1);
  while (!field.empty() && (field.front() == ' ' || field.front() == '\t'))
    field.remove_prefix(1);
  while (!field.empty() && (field.back() == ' ' || field.back() == '\t'))
    field.remove_suffix(1);
  return field;
}

/// Parses milliseconds with up to six decimals, exactly.
bool
parse_time(std::string_view field, Time &time)
{
  Time::rep ms = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), ms);
  if (error != std::errc() || ms < 0 || ms > Track::kMaxEnd.count() / kNsPerMs)
    return false;
  field.remove_prefix(static_cast<std::size_t>(end - field.data()));
  Time::rep ns = 0;
  if (field.starts_with('.')) {
    field.remove_prefix(1);
    if (field.empty())
      return false;
    Time::rep unit = kNsPerMs / 10;
    for (; !field.empty() && field.front() >= '0' && field.front() <= '9'; unit /= 10) {
      if (unit == 0 && field.front() != '0')
        return false;
      ns += unit * (field.front() - '0');
      field.remove_prefix(1);
    }
  }
  time = Time(ms * kNsPerMs + ns);
  return field.empty() && time <= Track::kMaxEnd;
}

std::string
column_names(std::size_t tactors, bool has_frequency)
{
  std::string names = "time_ms";
  for (std::size_t i = 0; i < tactors; i++) {
    names += ",t";
    append_number(names, i);
  }
  return has_frequency ? names + ",hz" : names;
}

/// Removes trailing commas, with which spreadsheets fill up short lines.
std::string_view
without_trailing_commas(std::string_view line)
{
  while (line.ends_with(','))
    line.remove_suffix(1);
  return line;
}

tl::unexpected<FormatError>
wrong(std::size_t line, std::string reason)
{
  return tl::unexpected(FormatError::at_line(line, std::move(reason)));
}

tl::expected<Track, FormatError>
read_header(LineReader &lines, bool &has_frequency)
{
  if (!lines.next() || !lines.line().starts_with("# tactile "))
    return wrong(1, "expected '# tactile grid=ROWSxCOLUMNS'");
  const auto header = read_grid(without_trailing_commas(lines.line()).substr(10), lines.number());
  if (!header)
    return tl::unexpected(header.error());
  if (!header->grid)
    return wrong(1, "expected '# tactile grid=ROWSxCOLUMNS'");
  Track track(header->grid->rows, header->grid->columns);
  track.set_rate(header->rate);
  const std::size_t tactors = track.entries().front().map.levels.size();
  const bool has_names = lines.next();
  has_frequency = has_names && lines.line() == column_names(tactors, true);
  if (!has_frequency && !(has_names && lines.line() == column_names(tactors, false)))
    return wrong(2, "expected the columns time_ms and t0 to t" + std::to_string(tactors - 1)
                        + ", perhaps hz, separated by commas");
  return track;
}

/// Parses the fields after the time.
tl::expected<void, FormatError>
read_map(std::string_view line, std::size_t number, bool has_frequency, TactileMap &map)
{
  std::vector<float> &levels = map.levels;
  for (float &level : levels) {
    const std::string_view field = take_field(line);
    level = visuotactile::read_number<float>(field).value_or(-1);
    if (!(level >= 0 && level <= 1))
      return wrong(number, "expected " + std::to_string(levels.size())
                               + " levels from 0 to 1, got '" + std::string(field.substr(0, 20))
                               + "'");
  }
  if (has_frequency) {
    const std::string_view field = take_field(line);
    map.frequency = visuotactile::read_number<float>(field).value_or(-1);
    if (!(map.frequency == 0 || (map.frequency >= 1 && map.frequency <= kHighestFrequency)))
      return wrong(number, "expected a frequency from 1 to 1000 Hz, or 0, got '"
                               + std::string(field.substr(0, 20)) + "'");
  }
  if (!without_trailing_commas(line).empty())
    return wrong(number, "more levels than the grid has cells");
  return {};
}

} // namespace

std::string
write_csv(const Track &track)
{
  std::string text
      = "# tactile " + write_grid({ track.rows(), track.columns() }, track.rate()) + "\n";
  const bool tuned = has_frequency(track);
  text += column_names(track.entries().front().map.levels.size(), tuned) + "\n";
  for (const Track::Entry &entry : track.entries())
    if (entry.time < track.end())
      append_line(text, entry.time, entry.map, tuned);
  append_line(text, track.end(), TactileMap(track.rows(), track.columns()), tuned);
  return text;
}

tl::expected<Track, FormatError>
read_csv(std::string_view text)
{
  LineReader lines(text);
  bool tuned = false;
  tl::expected<Track, FormatError> track = read_header(lines, tuned);
  if (!track)
    return track;
  TactileMap map(track->rows(), track->columns());
  Time time{ -1 };
  while (lines.next()) {
    std::string_view line = lines.line();
    if (without_trailing_commas(line).empty())
      continue;
    const Time previous = time;
    if (!parse_time(take_field(line), time))
      return wrong(lines.number(), "expected a time in milliseconds, up to 100 hours");
    if (time <= previous)
      return wrong(lines.number(), "the time is not after that of the line before");
    if (const auto read = read_map(line, lines.number(), tuned, map); !read)
      return tl::unexpected(read.error());
    if (const auto appended = track->append(time, map); !appended)
      return wrong(lines.number(), appended.error().reason);
  }
  if (time < Time(0))
    return wrong(lines.number(), "expected a line that ends the track");
  if (!is_silent(map))
    return wrong(lines.number(), "the last line ends the track: expected levels of 0");
  (void)track->set_end(time);
  return track;
}

} // namespace tactile
