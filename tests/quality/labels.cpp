// SPDX-License-Identifier: LGPL-2.1-or-later
#include "labels.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace quality {

namespace {

constexpr std::size_t kCells = 9;
constexpr Time kWindow = std::chrono::milliseconds(500);
constexpr float kFull = 0.9F;

[[noreturn]] void
refuse(const std::filesystem::path &file, int line, const std::string &expected)
{
  throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": expected " + expected);
}

/// Seconds with up to three decimals.
Time
parse_time(const std::string &text, const std::filesystem::path &file, int line)
{
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc{} || end != text.data() + text.size() || seconds < 0 || seconds > 1e5)
    refuse(file, line, "seconds, got '" + text + "'");
  return std::chrono::milliseconds(std::llround(seconds * 1000));
}

Label
parse_label(const std::string &text, const std::filesystem::path &file, int line)
{
  std::istringstream fields(text);
  std::string start;
  std::string end;
  std::string verdict;
  std::string cells;
  std::string strength;
  if (!std::getline(fields, start, ',') || !std::getline(fields, end, ',')
      || !std::getline(fields, verdict, ',') || !std::getline(fields, cells, ',')
      || !std::getline(fields, strength, ','))
    refuse(file, line, "start,end,verdict,cells,strength,what");
  Label label;
  label.start = parse_time(start, file, line);
  label.end = parse_time(end, file, line);
  label.verdict
      = verdict == "felt"      ? Verdict::felt
        : verdict == "allowed" ? Verdict::allowed
        : verdict == "quiet"
            ? Verdict::quiet
            : (refuse(file, line, "felt, allowed or quiet, got '" + verdict + "'"), Verdict::quiet);
  label.anywhere = cells == "*";
  label.cells.assign(kCells, label.anywhere);
  std::getline(fields, label.what);
  if (strength.size() > 1 || (strength.size() == 1 && (strength[0] < '1' || strength[0] > '3'))
      || (strength.empty() == (label.verdict == Verdict::felt)))
    refuse(file, line, "a strength of 1 to 3 if it is felt, else none, got '" + strength + "'");
  label.strength = strength.empty() ? 0 : strength[0] - '0';
  std::istringstream numbers(label.anywhere ? "" : cells);
  for (std::string number; numbers >> number;) {
    if (number.size() != 1 || number[0] < '0' || number[0] > '8')
      refuse(file, line, "cells 0 to 8, got '" + number + "'");
    label.cells[static_cast<std::size_t>(number[0] - '0')] = true;
  }
  if ((label.verdict == Verdict::quiet) != std::ranges::none_of(label.cells, std::identity{}))
    refuse(file, line, "cells unless it is quiet");
  return label;
}

} // namespace

std::vector<Label>
read_labels(const std::filesystem::path &file)
{
  std::ifstream in(file);
  std::string text;
  if (!std::getline(in, text) || text != "start,end,verdict,cells,strength,what")
    refuse(file, 1, "start,end,verdict,cells,strength,what");
  std::vector<Label> labels;
  for (int line = 2; std::getline(in, text); ++line) {
    labels.push_back(parse_label(text, file, line));
    const Time before = labels.size() > 1 ? labels[labels.size() - 2].end : Time(0);
    if (labels.back().start != before || labels.back().end <= before)
      refuse(file, line, "a span that begins where the one before ends");
  }
  return labels;
}

std::vector<Mean>
above(const std::vector<double> &strong, const std::vector<double> &weak)
{
  std::vector<Mean> found;
  for (const double level : strong) {
    Mean &share = found.emplace_back();
    for (const double other : weak)
      share.add(level > other ? 1 : level == other ? 0.5 : 0);
  }
  return found;
}

LabelJudge::LabelJudge(std::vector<Label> labels)
    : labels_(std::move(labels)), right_(labels_.size()), quiet_(labels_.size()),
      favorites_(labels_.size()), levels_(labels_.size())
{
  for (const Label &label : labels_)
    found_.emplace_back(label.verdict == Verdict::felt ? static_cast<std::size_t>(
                            (label.end - label.start + kWindow - Time(1)) / kWindow)
                                                       : 0);
}

void
LabelJudge::frame(Time time, const tactile::TactileMap &map)
{
  const auto label = std::ranges::find_if(
      labels_, [time](const Label &span) { return span.start <= time && time < span.end; });
  if (label == labels_.end() || map.levels.size() != kCells)
    return;
  const auto strongest = std::ranges::max_element(map.levels);
  const bool felt = *strongest > 0;
  const bool right = felt && label->cells[static_cast<std::size_t>(strongest - map.levels.begin())];
  if (right && label->verdict == Verdict::felt)
    found_[static_cast<std::size_t>(label - labels_.begin())]
          [static_cast<std::size_t>((time - label->start) / kWindow)]
        = true;
  const auto span = static_cast<std::size_t>(label - labels_.begin());
  levels_[span].push_back(static_cast<double>(*strongest));
  if (felt)
    full_.add(*strongest > kFull);
  if (label->verdict == Verdict::allowed && label->anywhere)
    return;
  felt_.add(felt);
  if (label->verdict == Verdict::quiet)
    quiet_[span].add(felt);
  if (!felt)
    return;
  right_[span].add(right);
  if (label->verdict != Verdict::quiet)
    ++favorites_[span][static_cast<std::size_t>(strongest - map.levels.begin())];
}

LabelScores
LabelJudge::scores() const
{
  LabelScores scores{ .right = right_, .quiet = quiet_ };
  Mean right;
  for (const Mean &span : right_)
    right.add(span);
  Mean found;
  for (const std::vector<bool> &windows : found_) {
    Mean &span = scores.found.emplace_back();
    for (const bool window : windows)
      span.add(window);
    found.add(span);
  }
  std::array<double, kCells> often{};
  double all = 0;
  for (const auto &favorites : favorites_)
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      often[cell] += favorites[cell];
      all += favorites[cell];
    }
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    Mean &place = scores.place.emplace_back();
    double chance = 0;
    for (std::size_t cell = 0; cell < kCells && all > 0; ++cell)
      chance += labels_[i].cells[cell] ? often[cell] / all : 0;
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      place.sum += favorites_[i][cell] * ((labels_[i].cells[cell] ? 1 : 0) - chance);
      place.count += favorites_[i][cell] * (1 - chance);
    }
  }
  Mean quiet;
  for (const Mean &span : quiet_)
    quiet.add(span);
  for (std::size_t i = 0; i < labels_.size(); ++i)
    if (std::vector<double> levels = levels_[i]; !levels.empty() && labels_[i].strength > 0) {
      const auto upper = levels.begin() + static_cast<std::ptrdiff_t>((levels.size() - 1) * 3 / 4);
      std::ranges::nth_element(levels, upper);
      scores.levels[static_cast<std::size_t>(labels_[i].strength)].push_back(*upper);
    }
  scores.quiet_felt = quiet.count > 0 ? quiet.value() : 0;
  scores.full = full_.count > 0 ? full_.value() : 0;
  scores.felt = felt_.count > 0 ? felt_.value() : 0;
  scores.precision = right.count > 0 ? right.value() : 1;
  scores.recall = found.count > 0 ? found.value() : 1;
  return scores;
}

} // namespace quality
