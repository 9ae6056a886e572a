// SPDX-License-Identifier: LGPL-2.1-or-later
#include "judge.h"

#include <algorithm>
#include <set>

namespace quality {

namespace {

constexpr Time kEventSpan = std::chrono::milliseconds(500);
constexpr Time kRestSpan = std::chrono::milliseconds(2200);
constexpr Time kFoundSpan = std::chrono::nanoseconds(1'000'000'000 / 3);

/// The cells that intersect a ball's bounding square.
std::set<std::size_t>
cells_of(const tactile::Ball &ball, cv::Size size, const tactile::TactileMap &map)
{
  const auto cell = [](double position, int length, int cells) {
    return std::clamp(static_cast<int>(position * cells / length), 0, cells - 1);
  };
  const double r = ball.radius - 1e-6;
  std::set<std::size_t> touched;
  for (int row = cell(ball.y - r, size.height, map.rows);
       row <= cell(ball.y + r, size.height, map.rows); ++row)
    for (int column = cell(ball.x - r, size.width, map.columns);
         column <= cell(ball.x + r, size.width, map.columns); ++column)
      touched.insert(static_cast<std::size_t>(row * map.columns + column));
  return touched;
}

} // namespace

void
Scores::add(const Scores &other)
{
  for (const auto figure : { &Scores::strongest, &Scores::energy, &Scores::silent, &Scores::delay,
                             &Scores::prompt, &Scores::pair, &Scores::active, &Scores::camera,
                             &Scores::cells, &Scores::found, &Scores::right })
    (this->*figure).add(other.*figure);
}

void
Judge::frame(const LabeledFilm &film, Time time, const std::vector<tactile::Ball> &balls,
             const tactile::TactileMap &map)
{
  film_ = &film;
  std::set<std::size_t> touched;
  std::map<int, Time> onsets;
  bool moving = false;
  bool all_felt = true;
  for (const auto &ball : balls) {
    const auto own = cells_of(ball, size_, map);
    all_felt &= std::ranges::any_of(own, [&](std::size_t cell) { return map.levels[cell] > 0; });
    touched.insert(own.begin(), own.end());
    moving |= ball.moving;
    onsets[ball.index] = ball.onset;
  }

  if (onsets != onsets_) {
    finish_onset(film);
    if (!first_ && !balls.empty()) {
      onset_ = Onset{ .time = time };
      last_event_ = time;
      last_pair_.reset();
      if (balls.size() == 2 && balls[0].onset == balls[1].onset)
        last_pair_ = time;
    } else if (!first_) {
      last_event_ = time;
    }
    onsets_ = onsets;
  }
  if (moving)
    last_event_ = time;
  first_ = false;

  double sum = 0;
  double inside = 0;
  double cells = 0;
  for (std::size_t i = 0; i < map.levels.size(); ++i) {
    sum += map.levels[i];
    inside += touched.contains(i) ? map.levels[i] : 0;
    cells += map.levels[i] > 0;
  }
  const auto strongest
      = static_cast<std::size_t>(std::ranges::max_element(map.levels) - map.levels.begin());
  const bool hit = sum > 0 && touched.contains(strongest);

  scores_.active.add(sum > 0);
  scores_.cells.add(cells);
  follow_onset(film, time, inside > 0, hit, sum > 0);
  if (last_event_ && time - *last_event_ <= kEventSpan) {
    scores_.strongest.add(hit);
    if (sum > 0)
      scores_.energy.add(inside / sum);
  }
  if (last_pair_ && time - *last_pair_ <= kEventSpan)
    scores_.pair.add(all_felt);
  if (time - last_event_.value_or(Time{}) >= kRestSpan)
    scores_.silent.add(sum == 0);
}

void
Judge::follow_onset(const LabeledFilm &film, Time time, bool touched, bool strongest, bool active)
{
  if (!onset_)
    return;
  if (time - onset_->time > kEventSpan && onset_->felt) {
    finish_onset(film);
    return;
  }
  if (touched && !onset_->felt) {
    onset_->felt = true;
    onset_->found = time - onset_->time <= kFoundSpan;
    scores_.delay.add(onset_->frames);
    scores_.prompt.add(onset_->frames == 0);
  }
  if (time - onset_->time <= kEventSpan) {
    onset_->active += active;
    onset_->right += strongest;
  }
  onset_->frames++;
}

void
Judge::finish_onset(const LabeledFilm &film)
{
  if (!onset_)
    return;
  if (!onset_->felt) {
    scores_.delay.add(onset_->frames); // never felt: its duration
    scores_.prompt.add(0);
  }
  if (film.visible(onset_->time)) {
    scores_.found.add(onset_->found);
    scores_.right.sum += onset_->right;
    scores_.right.count += onset_->active;
  }
  onset_.reset();
}

void
Judge::finish()
{
  if (film_)
    finish_onset(*film_);
}

} // namespace quality
