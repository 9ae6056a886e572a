// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/play.h"
#include "synth/shaker.h"

#include "support/tolerance.h"

#include <algorithm>
#include <cmath>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace synth;

namespace {

constexpr int kRate = 48000;

/// No limits, no soft start, and a lead of the rise time.
tactor::PlannerSettings
settings_for(Time rise)
{
  return { .rate = 0,
           .max_lead = rise,
           .volts_max = 1,
           .volts_min = 0,
           .limits = { .max_on_time = 0s, .max_duty = 0, .max_active = 0 } };
}

/// Channels whose samples are their amplitudes.
Play
make_play(std::size_t channels, Time rise, const tactor::PlannerSettings &settings)
{
  const auto one = std::make_shared<const Wave>(1, std::vector<float>{ 1 });
  Play play(kRate, std::vector<Voice>(channels, { one }), settings,
            std::vector<tactor::MotorParameters>(channels, shaker(rise, 1)));
  play.set_cells(plain_cells(1, static_cast<int>(channels), static_cast<int>(channels)));
  return play;
}

std::vector<float>
render_until(Play &play, Time time, std::size_t channels = 1)
{
  std::vector<float> samples(static_cast<std::size_t>(play.count_until(time)) * channels);
  play.render(samples);
  return samples;
}

/// Plays maps of 20 ms from the time 0 on, rendering what each one allows.
std::vector<float>
play_maps(Play &play, const std::vector<std::vector<float>> &maps)
{
  const std::size_t channels = maps.front().size();
  std::vector<float> samples;
  const auto add = [&](Time until) {
    const std::vector<float> more = render_until(play, until, channels);
    samples.insert(samples.end(), more.begin(), more.end());
  };
  Time time = 0s;
  play.begin(time);
  for (const std::vector<float> &map : maps) {
    play.plan(time, 20ms, map);
    time += 20ms;
    add(time - play.lead());
  }
  play.silence(time);
  add(time + 100ms);
  return samples;
}

std::vector<std::vector<float>>
repeated(std::vector<std::pair<float, int>> levels)
{
  std::vector<std::vector<float>> maps;
  for (const auto &[level, times] : levels)
    maps.insert(maps.end(), static_cast<std::size_t>(times), { level });
  return maps;
}

/// The first time at which the samples are at `level` or above, or below if it falls.
Time
reaches(const std::vector<float> &samples, float level, Time from, bool falls = false)
{
  const SampleGrid grid{ .rate = kRate };
  const auto begin = samples.begin() + grid.index_of(from);
  const auto found
      = std::find_if(begin, samples.end(), [&](float value) { return (value >= level) != falls; });
  fail_if(found == samples.end());
  return grid.time_of(found - samples.begin());
}

/// What a resonator makes of a carrier's amplitude: it follows with the time constant τ.
std::vector<float>
felt(const std::vector<float> &amplitude, Time tau)
{
  std::vector<float> felt;
  double state = 0;
  const double share = 1 - std::exp(-1 / (kRate * std::chrono::duration<double>(tau).count()));
  for (const float value : amplitude)
    felt.push_back(static_cast<float>(state += share * (static_cast<double>(value) - state)));
  return felt;
}

void
fail_unless_within(Time value, Time expected, Time tolerance)
{
  fail_unless(std::chrono::abs(value - expected) <= tolerance, "%lld us, expected %lld us",
              static_cast<long long>(value.count() / 1000),
              static_cast<long long>(expected.count() / 1000));
}

} // namespace

CHECK_TEST(test_half_way_at_the_frame)
{
  Play play = make_play(1, 0s, settings_for(0s));
  fail_unless(play.lead() == 6ms);
  const std::vector<float> sound
      = play_maps(play, repeated({ { 0, 10 }, { 0.8F, 10 }, { 0.4F, 10 } }));
  fail_unless_within(reaches(sound, 0.4F, 0s), 200ms, 50us);
  fail_unless_within(reaches(sound, 0.6F, 300ms, true), 400ms, 50us);
  fail_unless_within(reaches(sound, 0.2F, 500ms, true), 600ms, 50us); // the end
  fail_unless_equals_float(sound.back(), 0);
  fail_unless(play.is_idle());
}

CHECK_TEST(test_felt_at_the_frame)
{
  // 90 % of a resonator's rise is at the frame, from rest and from half. Its fall begins there.
  for (const Time rise : { Time(10ms), Time(25ms), Time(100ms) }) {
    Play play = make_play(1, rise, settings_for(rise));
    fail_unless(play.lead() == rise + 6ms);
    const std::vector<float> sound
        = play_maps(play, repeated({ { 0, 20 }, { 0.4F, 40 }, { 1, 40 }, { 0, 20 } }));
    const auto tau = Time(std::llround(static_cast<double>(rise.count()) / std::log(10.0)));
    const std::vector<float> follows = felt(sound, tau);
    fail_unless_within(reaches(follows, 0.9F * 0.4F, 0s), 400ms, 1ms);
    fail_unless_within(reaches(follows, 0.9F * 1, 1s), 1200ms, 1ms);
    fail_unless_within(reaches(sound, 0.5F, 1900ms, true), 2s, 50us);
  }
}

CHECK_TEST(test_same_in_parts)
{
  std::vector<std::vector<float>> maps;
  for (int i = 0; i < 200; i++)
    maps.push_back({ static_cast<float>(i * 7 % 11) / 10, static_cast<float>(i / 9 % 2) });
  Play whole = make_play(2, 25ms, settings_for(25ms));
  Play parts = make_play(2, 25ms, settings_for(25ms));
  const std::vector<float> sound = play_maps(whole, maps);
  std::vector<float> same;
  parts.begin(0s);
  for (int i = 0; i < 200; i++) {
    const Time time = i * 20ms;
    parts.plan(time, 20ms, maps[static_cast<std::size_t>(i)]);
    for (std::int64_t left = parts.count_until(time + 20ms - parts.lead()); left > 0; left -= 17) {
      std::vector<float> more(2 * static_cast<std::size_t>(std::min<std::int64_t>(left, 17)));
      parts.render(more);
      same.insert(same.end(), more.begin(), more.end());
    }
  }
  fail_unless(same.size() > 300000);
  fail_unless(std::equal(same.begin(), same.end(), sound.begin()));
}

CHECK_TEST(test_no_drift)
{
  // 44.1 kHz over a day: sample 44100 n is at n seconds.
  SampleGrid grid{ .origin = 3ns, .rate = 44100 };
  for (const std::int64_t n : { 0, 1, 86399, 86400, 1000000 }) {
    fail_unless(grid.time_of(44100 * n) == Time(3ns) + n * 1s);
    fail_unless_equals_int64(grid.index_of(Time(3ns) + n * 1s), 44100 * n);
  }
  for (std::int64_t i = -3; i < 100000; i += 7)
    fail_unless_equals_int64(grid.index_of(grid.time_of(i)), i);
}

CHECK_TEST(test_limits)
{
  tactor::PlannerSettings settings = settings_for(0s);
  settings.limits = { .max_on_time = 300ms, .max_duty = 0, .max_active = 1 };
  Play play = make_play(2, 0s, settings);
  // The stronger one alone, and not for longer than 300 ms.
  std::vector<std::vector<float>> maps(50, { 0.5F, 1 });
  const std::vector<float> sound = play_maps(play, maps);
  std::vector<float> weak;
  std::vector<float> strong;
  for (std::size_t i = 0; i < sound.size(); i += 2) {
    weak.push_back(sound[i]);
    strong.push_back(sound[i + 1]);
  }
  fail_unless_within(reaches(strong, 0.5F, 100ms, true), 300ms, 50us);
  fail_unless_equals_float(weak[kRate / 5], 0);
}

CHECK_TEST(test_mute_and_soft_start)
{
  Play play = make_play(1, 0s, settings_for(0s));
  play.set_soft_start(100ms);
  play.begin(0s);
  play.plan(0s, 20ms, std::vector{ 1.0F });
  const std::vector<float> start = render_until(play, 500ms);
  fail_unless_near(start[kRate * 50 / 1000], 0.5, 0.01);
  fail_unless_near(start[kRate * 200 / 1000], 1, 1e-6);
  play.set_mute(true);
  const std::vector<float> muted = render_until(play, 600ms);
  fail_unless_near(muted[kRate * 6 / 1000], 0.5, 0.01);
  fail_unless_equals_float(muted[kRate * 12 / 1000], 0);
  play.set_mute(false);
  const std::vector<float> back = render_until(play, 800ms);
  fail_unless_near(back[kRate * 50 / 1000], 0.5, 0.01);
  fail_unless_near(back.back(), 1, 1e-6);
}

CHECK_TEST(test_reset)
{
  Play play = make_play(1, 25ms, settings_for(25ms));
  play.begin(0s);
  play.plan(0s, 20ms, std::vector{ 1.0F });
  fail_unless(render_until(play, 300ms).back() == 1);
  fail_if(play.is_idle());
  play.flush(true);
  fail_if(play.has_begun());
  play.begin(0s);
  fail_unless(play.is_idle());
  fail_unless_equals_float(render_until(play, 100ms).back(), 0);
  play.skip(kRate);
  fail_unless(play.now() == 1100ms);
  play.plan(1200ms, 20ms, std::vector{ 1.0F });
  fail_unless_equals_float(render_until(play, 1165ms).back(), 0);
  fail_unless_equals_float(render_until(play, 1300ms).back(), 1);
}

CHECK_TEST(test_frequencies)
{
  const auto sine = make_wave(Waveform::sine, 60);
  const auto play_of = [&](const std::vector<double> &frequencies) {
    Play play(kRate, { { .wave = sine, .frequency = 60 } }, settings_for(20ms),
              { shaker(20ms, 1) });
    play.set_cells(plain_cells(1, 1, 1));
    play.begin(0s);
    std::vector<float> samples;
    Time time = 0s;
    for (const double frequency : frequencies) {
      play.plan(time, 1s, std::vector{ 0.5F }, frequency);
      time += 1s;
      const auto more = render_until(play, time - play.lead());
      samples.insert(samples.end(), more.begin(), more.end());
    }
    return samples;
  };
  const std::vector<float> samples = play_of({ 0, 120, 120, 240, 0 });
  const std::vector<int> expected = { 60, 120, 120, 240 };
  for (std::size_t second = 0; second < expected.size(); second++) {
    int rounds = 0;
    for (std::size_t i = second * kRate + 1; i < (second + 1) * kRate; i++)
      rounds += samples[i - 1] < 0 && samples[i] >= 0 ? 1 : 0;
    fail_unless(std::abs(rounds - expected[second]) <= 1, "second %zu: %d", second, rounds);
  }
  // Without frequencies nothing changes.
  Play plain(kRate, { { .wave = sine } }, settings_for(20ms), { shaker(20ms, 1) });
  plain.set_cells(plain_cells(1, 1, 1));
  plain.begin(0s);
  plain.plan(0s, 1s, std::vector{ 0.5F });
  const auto unchanged = render_until(plain, 900ms);
  fail_unless(std::equal(unchanged.begin(), unchanged.end(), play_of({ 0 }).begin()));
}

/// A channel that begins early, by its rise time, begins with the frequency of its map.
CHECK_TEST(test_frequency_of_the_rise)
{
  Play play(kRate, { { .wave = make_wave(Waveform::sine, 50), .frequency = 50 } },
            settings_for(100ms), { shaker(100ms, 1) });
  play.set_cells(plain_cells(1, 1, 1));
  play.begin(0s);
  play.plan(0s, 1s, std::vector{ 0.0F });
  play.plan(1s, 1s, std::vector{ 1.0F }, 500);
  const std::vector<float> samples = render_until(play, 1s);
  const auto first = std::ranges::find_if(samples, [](float value) { return value != 0; });
  fail_unless(samples.end() - first > kRate / 50);
  const auto high = std::count_if(
      first + 1, samples.end(), [&](const float &value) { return (&value)[-1] < 0 && value >= 0; });
  const auto expected = (samples.end() - first) * 500 / kRate;
  fail_unless(std::abs(high - expected) <= 1, "%zd, expected %zd", std::ptrdiff_t(high),
              std::ptrdiff_t(expected));
}

CHECK_MAIN(synth_play)
