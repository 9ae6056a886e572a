// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/recording.h"

#include "files/regular_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>

namespace tactor {

namespace {

/// Limits on times in seconds and on rates: enough for a day and for ultrasound, and small enough
/// that nothing overflows.
constexpr double kLongestS = 1e5;
constexpr double kMostRate = 1e6;
constexpr double kGreatest = 1e12; ///< limit on values, in any unit
constexpr std::streamsize kLongestLine = 1 << 16;
constexpr std::size_t kMostBytes = std::size_t{ 1 } << 30;

using Error = tl::unexpected<std::string>;

/// The numbers of a line; empty if the first field is not a number. Fails if a later field is not a
/// number or is out of range.
tl::expected<std::vector<double>, std::string>
numbers(const std::string &line)
{
  std::vector<double> result;
  std::size_t from = 0;
  while (from <= line.size()) {
    std::size_t to = std::min(line.find_first_of(",;\t", from), line.size());
    std::string field = line.substr(from, to - from);
    std::erase_if(field, [](char c) { return c == ' ' || c == '\r' || c == '"' || c == '+'; });
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    const bool is_text = error == std::errc::invalid_argument || end != field.data() + field.size();
    if (is_text && result.empty())
      return result;
    if (is_text || error != std::errc() || !(std::abs(value) <= kGreatest))
      return Error("expected a number, got '" + field.substr(0, 40) + "'");
    result.push_back(value);
    from = to + 1;
  }
  return result;
}

/// Adds the samples of a row, whose first number is the time. Fails if the row does not fit those
/// before it.
tl::expected<void, std::string>
add_row(const std::vector<double> &row, std::vector<double> &times, Recording &recording)
{
  const double time = row.front();
  if (times.empty())
    recording.channels.resize(row.size() - 1);
  if (row.size() < 2 || row.size() - 1 != recording.channels.size())
    return Error("expected seconds and "
                 + std::to_string(std::max<std::size_t>(recording.channels.size(), 1))
                 + " values, got " + std::to_string(row.size()) + " numbers");
  if (!times.empty() && !(time > times.back()))
    return Error("expected a time after " + std::to_string(times.back()) + ", got "
                 + std::to_string(time));
  if ((times.size() + 1) * row.size() > Recording::kMostValues)
    return Error("more numbers than the " + std::to_string(Recording::kMostValues)
                 + " that are read");
  if (std::abs(time) > kLongestS)
    return Error("expected a time within " + std::to_string(kLongestS) + " s, got "
                 + std::to_string(time));
  times.push_back(time);
  for (std::size_t i = 0; i < recording.channels.size(); i++)
    recording.channels[i].push_back(row[i + 1]);
  return {};
}

/// Resamples the channels to the times first + i / rate.
void
resample(Recording &recording, const std::vector<double> &times)
{
  for (std::vector<double> &channel : recording.channels) {
    std::vector<double> even(channel.size());
    std::size_t after = 1;
    for (std::size_t i = 0; i < even.size(); i++) {
      const double time = times.front() + static_cast<double>(i) / recording.rate;
      while (after + 1 < times.size() && times[after] < time)
        after++;
      const double share
          = std::clamp((time - times[after - 1]) / (times[after] - times[after - 1]), 0.0, 1.0);
      even[i] = std::lerp(channel[after - 1], channel[after], share);
    }
    channel = std::move(even);
  }
}

} // namespace

int
Recording::channel_of(int tactor, int tactors) const
{
  const bool own = std::ssize(channels) >= tactors && tactor < std::ssize(channels);
  return own ? tactor : 0;
}

tl::expected<Recording, std::string>
read_csv_recording(const std::string &path)
{
  tl::expected<std::string, files::Error> text = files::read(path, kMostBytes);
  if (!text)
    return Error("cannot read '" + path + "': " + text.error().reason);
  std::istringstream file(*std::move(text));
  Recording recording;
  std::vector<double> times;
  std::vector<char> line(kLongestLine);
  for (std::size_t number = 1; file.getline(line.data(), kLongestLine) || file.gcount() > 0;
       number++) {
    const auto add = [&]() -> tl::expected<void, std::string> {
      if (file.fail())
        return Error("expected a line of at most " + std::to_string(kLongestLine) + " bytes");
      const tl::expected<std::vector<double>, std::string> row = numbers(line.data());
      if (!row)
        return Error(row.error());
      return row->empty() ? tl::expected<void, std::string>() : add_row(*row, times, recording);
    };
    if (const auto added = add(); !added)
      return Error(path + ", line " + std::to_string(number) + ": " + added.error());
  }
  if (times.size() < 2)
    return Error(path + ": expected lines of seconds and values, found "
                 + std::to_string(times.size()));
  recording.rate = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  if (!(recording.rate <= kMostRate))
    return Error(path + ": expected at most " + std::to_string(kMostRate)
                 + " samples a second, got " + std::to_string(recording.rate));
  recording.start = Time(std::llround(times.front() * 1e9));
  resample(recording, times);
  return recording;
}

} // namespace tactor
