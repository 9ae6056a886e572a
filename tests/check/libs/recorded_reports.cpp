// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What real players reported while their screen was watched (tests/tools/follow_record.py), and
// what we and others make of it. Kodi 20.1 was recorded on a busy computer, where its own frames
// were late. Lines: "report" and microseconds of receipt, of asking and of the position, what it
// does, its rate, whether it told a seek; "frame" and microseconds at which it came and of the
// film.
#include "follow/position_estimator.h"

#include "support/follow_peers.h"

#include <fstream>
#include <optional>
#include <string>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr Time kSettling = 3s; ///< after each event
constexpr Time kNear = 500ms;  ///< frames by which a position on the screen is known
constexpr Time kStep = 50ms;

struct Frame
{
  Time at;
  Time position;
};

struct Record
{
  std::vector<Report> reports{};
  std::vector<Frame> frames{};
};

std::vector<std::string>
fields_of(const std::string &line)
{
  std::vector<std::string> fields(1);
  for (const char c : line)
    if (c == ',')
      fields.emplace_back();
    else
      fields.back() += c;
  return fields;
}

Record
read(const char *name)
{
  Record record;
  std::ifstream file(std::string(g_getenv("TEST_DATA")) + "/follow/" + name + ".csv");
  for (std::string line; std::getline(file, line);) {
    const std::vector<std::string> fields = fields_of(line);
    const auto time = [&fields](std::size_t field) {
      return std::chrono::microseconds(std::stoll(fields.at(field)));
    };
    if (fields[0] == "frame") {
      record.frames.push_back({ time(1), time(2) });
      continue;
    }
    Report report{ .received = time(1),
                   .doing = static_cast<Doing>(std::stoi(fields.at(4))),
                   .rate = std::stod(fields.at(5)),
                   .sought = fields.at(6) == "1",
                   .film = "film" };
    if (!fields[2].empty())
      report.asked = time(2);
    if (!fields[3].empty())
      report.position = time(3);
    record.reports.push_back(report);
  }
  fail_if(record.reports.empty() || record.frames.empty(), "no record of %s", name);
  return record;
}

/// Where the film is on the screen, by the median frame; none: too few frames.
std::optional<Time>
truth(const std::vector<Frame> &frames, Time now, double rate)
{
  std::vector<double> positions;
  const auto first = std::ranges::lower_bound(frames, now - kNear, {}, &Frame::at);
  for (auto frame = first; frame != frames.end() && frame->at < now + kNear; ++frame)
    positions.push_back(static_cast<double>(frame->position.count())
                        + rate * static_cast<double>((now - frame->at).count()));
  if (positions.size() < 12)
    return std::nullopt;
  std::ranges::nth_element(positions, positions.begin() + positions.size() / 2);
  return Time(std::llround(positions[positions.size() / 2]));
}

struct Errors
{
  std::vector<double> ms{};

  void add(Time error, double rate)
  {
    ms.push_back(std::abs(static_cast<double>(error.count()) / 1e6 / rate));
  }
  double quantile(double share)
  {
    std::ranges::sort(ms);
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
  }
};

struct Comparison
{
  Errors ours{};
  Errors median{};
  Errors third{};
  std::size_t asked = 0;
};

/// From kSettling after each event on, while it plays.
Comparison
compare(const Record &record, const Habits &habits)
{
  PositionEstimator estimator({ .habits = habits });
  MedianOfOffsets median;
  ThirdOfTheWay third;
  Comparison all;
  Time event = record.reports.front().received;
  const Report *last = nullptr;
  Time now = event;
  for (const Report &report : record.reports) {
    for (; now < report.received; now += kStep) {
      if (last == nullptr || last->doing != Doing::playing || now < event + kSettling)
        continue;
      const std::optional<Time> screen = truth(record.frames, now, last->rate);
      if (!screen)
        continue;
      all.asked++;
      if (const auto estimate = estimator.at(now); estimate && estimate->rate > 0) {
        all.ours.add(estimate->position - *screen, last->rate);
        all.median.add(median.at(now) - *screen, last->rate);
        all.third.add(third.at(now) - *screen, last->rate);
      }
    }
    if (last == nullptr || report.doing != last->doing || report.rate != last->rate
        || report.sought)
      event = report.received;
    estimator.report(report);
    median.report(report);
    third.report(report);
    last = &report;
  }
  return all;
}

/// For how long after the film has leapt on the screen the estimate is of before.
Time
stale(const Record &record, const Habits &habits)
{
  const auto leap = std::ranges::adjacent_find(
      record.frames, [](const Frame &a, const Frame &b) { return b.position - a.position > 5s; });
  fail_if(leap == record.frames.end(), "no leap");
  const Frame &first = *std::next(leap);
  PositionEstimator estimator({ .habits = habits });
  Time last = first.at;
  auto report = record.reports.begin();
  for (Time now = first.at; now < first.at + kSettling; now += 1ms) {
    for (; report != record.reports.end() && report->received <= now; ++report)
      estimator.report(*report);
    const auto estimate = estimator.at(now);
    if (estimate && estimate->position < first.position - 1s)
      last = now;
  }
  return last - first.at;
}

/// To `most` ms, and to this share of the others' errors.
void
assert_known(const char *name, const Habits &habits, double most, double share = 0.5)
{
  const Record record = read(name);
  const auto old = std::chrono::duration_cast<std::chrono::milliseconds>(stale(record, habits));
  g_print("%s: %d ms of before a seek\n", name, static_cast<int>(old.count()));
  fail_unless(old <= 50ms);
  Comparison found = compare(record, habits);
  g_print("%s: %.1f / %.1f ms, median of offsets %.1f / %.1f ms, a third of the way %.1f / %.1f "
          "ms\n",
          name, found.ours.quantile(0.5), found.ours.quantile(0.95), found.median.quantile(0.5),
          found.median.quantile(0.95), found.third.quantile(0.5), found.third.quantile(0.95));
  fail_unless(found.ours.ms.size() * 100 >= found.asked * 95, "known %zu of %zu times",
              found.ours.ms.size(), found.asked);
  fail_unless(found.ours.quantile(0.95) <= most, "%.1f ms", found.ours.quantile(0.95));
  const double ours = found.ours.quantile(0.95);
  fail_unless(ours <= share * found.median.quantile(0.95)
              && ours <= share * found.third.quantile(0.95));
}

} // namespace

CHECK_TEST(test_mpv)
{
  assert_known("mpv", {}, 15);
}

CHECK_TEST(test_vlc)
{
  assert_known("vlc", { .coarseness = 400ms, .lingers = true }, 25);
}

CHECK_TEST(test_kodi)
{
  assert_known("kodi", { .coarseness = 300ms, .lingers = true }, 40);
}

CHECK_TEST(test_chromium)
{
  assert_known("chromium", { .coarseness = 200ms, .lingers = true }, 120,
               1); // itself tells it to 100 ms
}

CHECK_TEST(test_chromium_extended)
{
  assert_known("chromium-extended", { .coarseness = 200ms, .lingers = true }, 25);
}

CHECK_MAIN(recorded_reports)
