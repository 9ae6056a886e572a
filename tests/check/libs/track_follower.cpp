// SPDX-License-Identifier: LGPL-2.1-or-later
//
// When cues of a track are to be felt, against when their frames are shown.
#include "follow/track_follower.h"

#include "support/simulated_player.h"

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace follow;

namespace {

constexpr Time kBegin = 100s;
constexpr Time kAhead = 350ms;

/// Silent, but for 0.3 s from each whole second on.
tactile::Track
pulses(int seconds)
{
  tactile::Track track(1, 1);
  tactile::TactileMap on(1, 1);
  on.levels[0] = 1;
  for (int second = 1; second < seconds; second++) {
    fail_unless(track.append(second * 1s, on).has_value());
    fail_unless(track.append(second * 1s + 300ms, tactile::TactileMap(1, 1)).has_value());
  }
  fail_unless(track.set_end(seconds * 1s).has_value());
  return track;
}

PositionEstimator::Estimate
at(Time position, double rate = 1, std::uint64_t stretch = 1)
{
  return { .position = position, .rate = rate, .stretch = stretch };
}

TrackFollower
follower(int seconds = 60)
{
  TrackFollower follower;
  follower.set_track(std::make_shared<tactile::Draft>(pulses(seconds)));
  return follower;
}

bool
is_on(const tactile::Cue &cue)
{
  return cue.map.levels[0] > 0;
}

} // namespace

CHECK_TEST(test_ahead)
{
  TrackFollower chair = follower();
  TrackFollower::Step step = chair.step(at(1900ms), kBegin, kAhead);
  fail_if(step.silence);
  ck_assert_uint_eq(step.cues.size(), 2);
  ck_assert(!is_on(step.cues[0]) && step.cues[0].begin == kBegin);
  ck_assert(is_on(step.cues[1]) && step.cues[1].begin == kBegin + 100ms);
  ck_assert(step.cues[1].end == kBegin + 400ms);
  // Each once.
  step = chair.step(at(1920ms), kBegin + 20ms, kAhead);
  ck_assert(!step.silence && step.cues.empty());
  // As soon as it is within reach, by what is known then: the film is 4 ms further.
  step = chair.step(at(2054ms), kBegin + 150ms, kAhead);
  ck_assert_uint_eq(step.cues.size(), 1);
  ck_assert(!is_on(step.cues[0]) && step.cues[0].begin == kBegin + 396ms);
}

/// A level that lasts is told again each second, so that the chair knows that it still holds.
CHECK_TEST(test_long_cues)
{
  TrackFollower chair = follower(2);
  const TrackFollower::Step step = chair.step(at(1500ms), kBegin, 4s);
  ck_assert_uint_eq(step.cues.size(), 5);
  for (std::size_t i = 0; i < step.cues.size(); i++) {
    fail_if(is_on(step.cues[i]));
    ck_assert(i == 0 || step.cues[i].begin == step.cues[i - 1].end);
  }
  ck_assert(step.cues[0].end == kBegin + 500ms); // the track's end
}

CHECK_TEST(test_rate)
{
  TrackFollower chair = follower();
  const TrackFollower::Step step = chair.step(at(1900ms, 2), kBegin, kAhead);
  ck_assert_uint_eq(step.cues.size(), 3);
  ck_assert(is_on(step.cues[1]) && step.cues[1].begin == kBegin + 50ms);
  ck_assert(step.cues[1].end == kBegin + 200ms);
}

CHECK_TEST(test_offset)
{
  TrackFollower chair = follower();
  chair.set_delay(60ms); // the picture is later
  TrackFollower::Step step = chair.step(at(1900ms), kBegin, kAhead);
  ck_assert(is_on(step.cues.at(1)) && step.cues[1].begin == kBegin + 160ms);
  // Before the film's beginning there is nothing.
  TrackFollower early = follower();
  early.set_delay(500ms);
  step = early.step(at(0s), kBegin, 1s);
  ck_assert(step.cues.at(0).begin == kBegin + 500ms);
}

/// Each silences, once, and what comes then is of where the film is.
CHECK_TEST(test_silence)
{
  TrackFollower chair = follower();
  ck_assert(!chair.step(std::nullopt, kBegin, kAhead).silence);
  ck_assert(!chair.step(at(2s), kBegin, kAhead).cues.empty());

  TrackFollower::Step step = chair.step(at(30s + 100ms, 1, 2), kBegin + 20ms, kAhead); // a seek
  ck_assert(step.silence && is_on(step.cues.at(0)));
  ck_assert(step.cues[0].begin == kBegin + 20ms && step.cues[0].end == kBegin + 220ms);

  step = chair.step(std::nullopt, kBegin + 40ms, kAhead); // unknown
  ck_assert(step.silence && step.cues.empty());
  ck_assert(!chair.step(std::nullopt, kBegin + 60ms, kAhead).silence);
  step = chair.step(at(30s + 140ms, 1, 2), kBegin + 80ms, kAhead);
  ck_assert(!step.silence && step.cues.at(0).begin == kBegin + 80ms);

  step = chair.step(at(30s + 160ms, 0, 2), kBegin + 100ms, kAhead); // a pause
  ck_assert(step.silence && step.cues.empty());

  ck_assert(!chair.step(at(2s, 1, 3), kBegin + 120ms, kAhead).cues.empty());
  chair.set_track(nullptr);
  step = chair.step(at(2020ms, 1, 3), kBegin + 140ms, kAhead);
  ck_assert(step.silence && step.cues.empty());
}

/// A track that becomes known while it plays.
CHECK_TEST(test_draft)
{
  const auto draft = std::make_shared<tactile::Draft>(1, 1);
  tactile::TactileMap on(1, 1);
  on.levels[0] = 1;
  fail_unless(draft->set(10s, 10s + 200ms, on).has_value());
  TrackFollower chair;
  chair.set_track(draft);
  TrackFollower::Step step = chair.step(at(10s), kBegin, kAhead);
  ck_assert_uint_eq(step.cues.size(), 3);
  ck_assert(is_on(step.cues[0]) && step.cues[0].end == kBegin + 200ms);
  // Silence, by moments.
  ck_assert(!is_on(step.cues[1]) && step.cues[1].end == kBegin + 300ms);
  ck_assert(!is_on(step.cues[2]) && step.cues[2].end == kBegin + 400ms);
  fail_unless(draft->set(10s + 200ms, 12s, on).has_value());
  step = chair.step(at(10s + 100ms), kBegin + 100ms, kAhead);
  ck_assert_uint_eq(step.cues.size(), 1);
  ck_assert(is_on(step.cues[0]) && step.cues[0].begin == kBegin + 400ms);
  ck_assert(step.cues[0].end == kBegin + 1400ms);
}

/// Each player counts its own stretches.
CHECK_TEST(test_another_player)
{
  TrackFollower chair = follower();
  ck_assert(!chair.step(at(30s + 100ms), kBegin, kAhead).cues.empty());
  chair.change_player();
  const TrackFollower::Step step = chair.step(at(2s), kBegin + 20ms, kAhead);
  ck_assert(step.silence && step.cues.at(0).begin == kBegin + 20ms);
}

/// A main loop that hung: what is past is not felt, and not made up for.
CHECK_TEST(test_hang)
{
  TrackFollower chair = follower();
  ck_assert(!chair.step(at(2s), kBegin, kAhead).cues.empty());
  const TrackFollower::Step step = chair.step(at(12s + 200ms), kBegin + 10s + 200ms, kAhead);
  ck_assert_uint_eq(step.cues.size(), 2);
  ck_assert(is_on(step.cues[0]) && step.cues[0].begin == kBegin + 10s + 200ms);
  ck_assert(step.cues[0].end == kBegin + 10s + 300ms);
}

/// Reports, estimate and cues together, with seeks that nobody tells, pauses and another rate.
CHECK_TEST(test_whole)
{
  WatchedFilm film(kBegin, 0s, 150e-6);
  film.seek(kBegin + 20s + 650ms, 47s)
      .change(kBegin + 40s + 450ms, Doing::paused)
      .change(kBegin + 45s, Doing::playing)
      .change(kBegin + 60s + 450ms, Doing::playing, 1.25)
      .seek(kBegin + 80s, 2s);
  Telling telling = told_by_frame();
  telling.tells_seeks = false;
  PositionEstimator estimator;
  TrackFollower chair = follower(200);
  std::vector<Time> felt;
  Time now = kBegin;
  for (const Report &report : reports_of(film, telling, kBegin + 100s, 9)) {
    for (; now < report.received; now += 20ms) {
      const TrackFollower::Step step = chair.step(estimator.at(now), now, kAhead);
      if (step.silence)
        std::erase_if(felt, [now](Time begin) { return begin > now; });
      for (const tactile::Cue &cue : step.cues)
        if (is_on(cue) && cue.begin > now + 100ms) // a whole one
          felt.push_back(cue.begin);
    }
    estimator.report(report);
  }
  int settled = 0;
  for (const Time begin : felt) {
    if (begin > now || begin < film.stretch(begin).begin + 1s)
      continue;
    const Time off = film.position(begin) % 1s;
    const Time error = off > 500ms ? off - 1s : off;
    fail_unless(std::chrono::abs(error) < 2ms, "off by %.2f ms at %.3f s",
                static_cast<double>(error.count()) / 1e6,
                static_cast<double>((begin - kBegin).count()) / 1e9);
    settled++;
  }
  fail_unless(settled > 80, "%d of %zu pulses", settled, felt.size());
}

CHECK_MAIN(track_follower)
