// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/calibration/recording.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace tactor {

namespace {

/// Of time, and so of a second: enough for a day and for ultrasound, and no number on the way overflows.
constexpr double kLongestS = 1e5;
constexpr double kMostRate = 1e6;
constexpr double kGreatest = 1e12; ///< of values, in any unit
constexpr std::streamsize kLongestLine = 1 << 16;

/// The numbers of a line; empty if it does not begin with one. Throws what is no number further on, or none that is read.
std::vector<double>
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
      return {};
    if (is_text || error != std::errc() || !(std::abs(value) <= kGreatest))
      throw std::runtime_error("expected a number, got '" + field.substr(0, 40) + "'");
    result.push_back(value);
    from = to + 1;
  }
  return result;
}

/// The channels at times first + i / rate.
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

Recording
read_csv_recording(const std::string &path)
{
  std::ifstream file(path);
  if (!file)
    throw std::runtime_error("cannot read '" + path
                             + "': " + std::generic_category().message(errno));
  Recording recording;
  std::vector<double> times;
  std::string line;
  std::vector<char> buffer(kLongestLine);
  for (std::size_t number = 1; file.getline(buffer.data(), kLongestLine) || file.gcount() > 0;
       number++) {
    const auto fail = [&](const std::string &why) {
      throw std::runtime_error(path + ", line " + std::to_string(number) + ": " + why);
    };
    if (file.fail())
      fail("expected a line of at most " + std::to_string(kLongestLine) + " bytes");
    line = buffer.data();
    std::vector<double> row;
    try {
      row = numbers(line);
    } catch (const std::runtime_error &e) {
      fail(e.what());
    }
    if (row.empty())
      continue;
    if (times.empty())
      recording.channels.resize(row.size() - 1);
    if (row.size() < 2 || row.size() - 1 != recording.channels.size())
      fail("expected seconds and "
           + std::to_string(std::max<std::size_t>(recording.channels.size(), 1)) + " values, got "
           + std::to_string(row.size()) + " numbers");
    if (!times.empty() && !(row[0] > times.back()))
      fail("expected a time after " + std::to_string(times.back()) + ", got "
           + std::to_string(row[0]));
    if ((times.size() + 1) * row.size() > Recording::kMostValues)
      fail("more numbers than the " + std::to_string(Recording::kMostValues) + " that are read");
    if (std::abs(row[0]) > kLongestS)
      fail("expected a time within " + std::to_string(kLongestS) + " s, got "
           + std::to_string(row[0]));
    times.push_back(row[0]);
    for (std::size_t i = 0; i < recording.channels.size(); i++)
      recording.channels[i].push_back(row[i + 1]);
  }
  if (times.size() < 2)
    throw std::runtime_error(path + ": expected lines of seconds and values, found "
                             + std::to_string(times.size()));
  recording.rate = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  if (!(recording.rate <= kMostRate))
    throw std::runtime_error(path + ": expected at most " + std::to_string(kMostRate)
                             + " samples a second, got " + std::to_string(recording.rate));
  recording.start = Time(std::llround(times.front() * 1e9));
  resample(recording, times);
  return recording;
}

} // namespace tactor
