// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/sound_analyzer.h"
#include "sound/synthetic_sound.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace sound;

namespace {

constexpr int kTestRate = 48000;

std::vector<float>
render(const SyntheticSound &made, double seconds, int rate, std::span<const Speaker> speakers)
{
  std::vector<float> frames(static_cast<std::size_t>(seconds * rate) * speakers.size());
  made.render(rate, 0, speakers, frames);
  return frames;
}

/// In blocks of `block` frames.
std::vector<Moment>
analyze(std::span<const float> frames, int rate, std::span<const Speaker> speakers,
        std::size_t block = 4096, bool looks_ahead = false)
{
  SoundAnalyzer analyzer(rate, speakers, looks_ahead);
  std::vector<Moment> result;
  block *= speakers.size();
  for (std::size_t at = 0; at < frames.size(); at += block) {
    const auto some = analyzer.add(frames.subspan(at, std::min(block, frames.size() - at)), {});
    result.insert(result.end(), some.begin(), some.end());
  }
  return result;
}

/// The moments at which an impact begins.
std::vector<Time>
onsets(std::span<const Moment> moments)
{
  std::vector<Time> result;
  for (const Moment &moment : moments)
    if (moment.onset)
      result.push_back(moment.begin);
  return result;
}

double
share_on(std::span<const Moment> moments)
{
  return static_cast<double>(
             std::ranges::count_if(moments, [](const Moment &moment) { return moment.level > 0; }))
         / static_cast<double>(moments.size());
}

/// A tone that swells in 0.1 s, mono: it begins without an impact.
std::vector<float>
tone(double hz, double amplitude, double seconds)
{
  std::vector<float> frames(static_cast<std::size_t>(seconds * kTestRate));
  for (std::size_t i = 0; i < frames.size(); i++)
    frames[i] = static_cast<float>(
        amplitude * std::min(1.0, static_cast<double>(i) / kTestRate / 0.1)
        * std::sin(2 * std::numbers::pi * hz * static_cast<double>(i) / kTestRate));
  return frames;
}

} // namespace

// Each impact has one onset within 20 ms, and nothing else has one.
CHECK_TEST(test_impacts)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2001, .seconds = 20 });
  const auto found = onsets(analyze(render(made, 20, kTestRate, speakers), kTestRate, speakers));
  ck_assert_uint_ge(made.events().size(), 8);
  ck_assert_uint_eq(found.size(), made.events().size());
  for (std::size_t i = 0; i < found.size(); i++)
    fail_unless(std::chrono::abs(found[i] - made.events()[i].begin)
                <= std::chrono::milliseconds(20));
}

// The same bits for any size of buffers.
CHECK_TEST(test_blocks)
{
  const auto speakers = usual_speakers(6);
  const SyntheticSound made({ .seed = 2002, .seconds = 5, .music = true, .impacts_db = -10 });
  const auto frames = render(made, 5, kTestRate, speakers);
  const auto expected = analyze(frames, kTestRate, speakers);
  fail_unless(!onsets(expected).empty());
  for (const std::size_t block : { 1, 37, 441, 100000 }) {
    const auto moments = analyze(frames, kTestRate, speakers, block);
    ck_assert_uint_eq(moments.size(), expected.size());
    for (std::size_t i = 0; i < moments.size(); i++) {
      fail_unless(moments[i].level == expected[i].level);
      fail_unless(moments[i].place == expected[i].place);
      fail_unless(moments[i].onset == expected[i].onset);
    }
  }
}

// The same impacts at any rate, within 10 ms; nearly the same levels.
CHECK_TEST(test_rates)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2003, .seconds = 10 });
  const auto expected = analyze(render(made, 10, kTestRate, speakers), kTestRate, speakers);
  for (const int rate : { 16000, 22050, 44100, 44101, 96000, 192000 }) {
    const auto moments = analyze(render(made, 10, rate, speakers), rate, speakers);
    const auto found = onsets(moments);
    const auto wanted = onsets(expected);
    ck_assert_uint_eq(found.size(), wanted.size());
    for (std::size_t i = 0; i < found.size(); i++)
      fail_unless(std::chrono::abs(found[i] - wanted[i]) <= std::chrono::milliseconds(10));
    double difference = 0;
    const std::size_t count = std::min(moments.size(), expected.size());
    for (std::size_t i = 0; i < count; i++)
      difference += std::abs(static_cast<double>(moments[i].level - expected[i].level));
    fail_unless(difference / static_cast<double>(count) < 0.01);
  }
}

// −50 dB of full scale is felt as 0 and −10 dB as 1: a tone of 40 Hz at −20 dB as 0.75.
CHECK_TEST(test_rumble)
{
  const auto mono = usual_speakers(1);
  const auto moments = analyze(tone(40, 0.1 * std::numbers::sqrt2, 2), kTestRate, mono);
  fail_unless_near(moments.back().level, 0.75, 0.02);
  fail_unless_near(moments.back().place.everywhere, 1, 1e-6);
  // A voice's pitch is not deep.
  fail_unless_near(share_on(analyze(tone(150, 0.5, 2), kTestRate, mono)), 0, 1e-6);
  // Too weak.
  fail_unless_near(share_on(analyze(tone(40, 0.01, 2), kTestRate, mono)), 0, 1e-6);
}

// Puffs of breath into a microphone last 100 ms at most: where somebody speaks as loud, what is
// deep has to last longer to be rumble. Elsewhere it may be a film's.
CHECK_TEST(test_puffs)
{
  const auto heard = [](double vowel, double lasts) {
    std::vector<float> frames(static_cast<std::size_t>(kTestRate) * 4);
    for (std::size_t i = 0; i < frames.size(); i++) {
      const double seconds = static_cast<double>(i) / kTestRate;
      const auto sine = [&](double hz) {
        return std::sin(2 * std::numbers::pi * hz * seconds);
      };
      // In each second, without a click.
      const auto swell = [&](double begin, double length) {
        const double at = (std::fmod(seconds, 1.0) - begin) / length;
        return at > 0 && at < 1 ? 0.5 - 0.5 * std::cos(2 * std::numbers::pi * at) : 0;
      };
      frames[i] = static_cast<float>(vowel * swell(0, 0.5)
                                         * (sine(120) + sine(240) + sine(360) + sine(480))
                                     + 0.15 * swell(0.5, lasts) * sine(40));
    }
    return share_on(analyze(frames, kTestRate, usual_speakers(1)));
  };
  fail_unless_near(heard(0.2, 0.1), 0, 1e-6);
  fail_unless(heard(0.2, 0.45) > 0.1);
  fail_unless(heard(0, 0.1) > 0.02);
}

// What is deep is no rumble where it is a small part of the sound, but for an LFE channel's.
CHECK_TEST(test_rumble_under_others)
{
  const auto deep = tone(40, 0.1 * std::numbers::sqrt2, 2);
  auto voice = tone(200, 0.3, 2);
  for (int partial = 2; partial <= 20; partial++) {
    const auto more = tone(200 * partial, 0.3 / partial, 2);
    std::ranges::transform(voice, more, voice.begin(), std::plus());
  }
  std::vector<float> both(deep.size());
  std::ranges::transform(deep, voice, both.begin(), std::plus());
  fail_unless_near(analyze(both, kTestRate, usual_speakers(1)).back().level, 0, 1e-6);

  std::vector<float> surround(deep.size() * 6);
  for (std::size_t i = 0; i < deep.size(); i++) {
    surround[6 * i + 2] = voice[i]; // center
    surround[6 * i + 3] = deep[i];  // LFE
  }
  // The film is loud, so that after two seconds everything counts up to 2.8 dB less.
  fail_unless_near(analyze(surround, kTestRate, usual_speakers(6)).back().level, 0.715, 0.04);
}

// The floor rises from -70 dB by a tenth of what is missing a second: -38.4 dB after 10 s, -26.8
// after 20, -22.5 after 30. A tone of -20 dB is felt in full from 12 dB above it, not at 3 dB.
CHECK_TEST(test_engine_fades)
{
  const auto mono = usual_speakers(1);
  SoundAnalyzer analyzer(kTestRate, mono);
  const auto heard = analyzer.add(tone(40, 0.1 * std::numbers::sqrt2, 30), {});
  const std::vector<Moment> moments(heard.begin(), heard.end());
  fail_unless_near(moments[2000].level, 0.75, 0.02);
  fail_unless_near(moments[4000].level, 0.75 * (6.77 - 3) / 9, 0.03);
  fail_unless_near(moments.back().level, 0, 1e-6);
  for (std::size_t i = 201; i < moments.size(); i++)
    fail_unless(std::abs(moments[i].level - moments[i - 1].level) < 0.03F);
  // After a rest it is felt again.
  analyzer.add(std::vector<float>(kTestRate * 5), {});
  fail_unless_near(analyzer.add(tone(40, 0.1 * std::numbers::sqrt2, 2), {}).back().level, 0.75,
                   0.02);
}

// The weaker an impact, the weaker it is felt, down to -24 dB at least: a level of 1 has 40 dB,
// and no step is a cliff.
CHECK_TEST(test_strength)
{
  constexpr double kStepDb = 8;
  const auto mono = usual_speakers(1);
  const SyntheticSound made({ .seed = 2008, .seconds = 12 });
  auto frames = render(made, 12, kTestRate, mono);
  std::vector<float> stronger;
  for (int step = 0; step <= 3; step++) {
    const auto moments = analyze(frames, kTestRate, mono);
    std::vector<float> levels;
    for (const SoundEvent &event : made.events()) {
      float level = 0;
      for (const Moment &moment : moments)
        if (moment.begin > event.begin - std::chrono::milliseconds(20)
            && moment.begin < event.begin + std::chrono::milliseconds(200))
          level = std::max(level, moment.level);
      fail_unless(level > 0, "%d dB weaker it is not felt", static_cast<int>(step * kStepDb));
      levels.push_back(level);
    }
    for (std::size_t i = 0; i < stronger.size(); i++)
      if (stronger[i] < 1)
        fail_unless_near(stronger[i] - levels[i], kStepDb / 40, 0.1);
    stronger = levels;
    for (float &frame : frames)
      frame *= static_cast<float>(std::pow(10, -kStepDb / 20));
  }
}

// The strength is relative to the film's loudness: at −23 and at −31 dB a film is felt the same,
// within a level of 2 dB, once half a minute of it has been heard.
CHECK_TEST(test_loudness)
{
  constexpr int kSeconds = 60;
  const auto mono = usual_speakers(1);
  const SyntheticSound made(
      { .seed = 2010, .seconds = kSeconds, .music = true, .music_db = -23, .impacts_db = -15 });
  auto frames = render(made, kSeconds, kTestRate, mono);
  const auto loud = analyze(frames, kTestRate, mono);
  for (float &frame : frames)
    frame *= static_cast<float>(std::pow(10, -8.0 / 20));
  const auto weak = analyze(frames, kTestRate, mono);
  double felt = 0;
  double difference = 0;
  for (std::size_t i = 30 * 200; i < loud.size(); i++) {
    felt += static_cast<double>(loud[i].level);
    difference += static_cast<double>(std::abs(loud[i].level - weak[i].level));
    fail_unless(loud[i].level == 0 || weak[i].level == 0
                || std::abs(loud[i].level - weak[i].level) <= 0.05F);
  }
  fail_unless(felt > 100);
  fail_unless(difference < 0.05 * felt);
}

// What is felt has the sound's own low pitch, within half of a third of an octave.
CHECK_TEST(test_pitch)
{
  const auto mono = usual_speakers(1);
  for (const double hz : { 25.0, 31.5, 40.0, 50.0, 60.0 }) {
    const auto moments = analyze(tone(hz, 0.1 * std::numbers::sqrt2, 2), kTestRate, mono);
    fail_unless(moments.back().level > 0);
    const double felt = static_cast<double>(moments.back().frequency);
    fail_unless(std::abs(std::log2(felt / hz)) < 0.2, "%.0f Hz is felt at %.0f Hz", hz, felt);
  }
}

// Impacts of 40 to 110 Hz are felt there, but for the begin of some with a crack; without low
// parts, above them.
CHECK_TEST(test_pitch_of_impacts)
{
  const auto mono = usual_speakers(1);
  const SyntheticSound made({ .seed = 2001, .seconds = 20 });
  auto frames = render(made, 20, kTestRate, mono);
  std::vector<float> high(frames.size());
  for (std::size_t i = 4; i < frames.size(); i++) // a fourth difference: 24 dB an octave
    high[i] = frames[i] - 4 * frames[i - 1] + 6 * frames[i - 2] - 4 * frames[i - 3] + frames[i - 4];
  const float loudest = std::ranges::max(high);
  for (float &frame : high)
    frame *= 0.7F / loudest;
  for (const bool is_high : { false, true }) {
    int impacts = 0;
    int felt = 0;
    int right = 0;
    for (const Moment &moment : analyze(is_high ? high : frames, kTestRate, mono)) {
      if (moment.level <= 0)
        continue;
      impacts += moment.onset ? 1 : 0;
      felt++;
      right += is_high == (moment.frequency > 130) ? 1 : 0;
      fail_unless(moment.frequency >= 20 && moment.frequency <= 320);
    }
    ck_assert_int_ge(10 * right, 9 * felt);
    ck_assert_int_ge(impacts, is_high ? 2 : 8); // most high ones are like hi-hats
  }
}

// With 80 ms more, the same impacts at the same times.
CHECK_TEST(test_looks_ahead)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2001, .seconds = 20 });
  const auto frames = render(made, 20, kTestRate, speakers);
  const auto found = onsets(analyze(frames, kTestRate, speakers, 4096, true));
  ck_assert_uint_eq(found.size(), made.events().size());
  for (std::size_t i = 0; i < found.size(); i++)
    fail_unless(std::chrono::abs(found[i] - made.events()[i].begin)
                <= std::chrono::milliseconds(20));
  fail_unless(SoundAnalyzer(kTestRate, speakers, true).delay()
              == SoundAnalyzer(kTestRate, speakers).delay() + std::chrono::milliseconds(80));
}

// Impacts 6 dB stronger than the music around them: most have an onset, little else has one.
CHECK_TEST(test_impacts_in_music)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2007, .seconds = 30, .music = true, .impacts_db = -14 });
  const auto found = onsets(analyze(render(made, 30, kTestRate, speakers), kTestRate, speakers));
  std::ptrdiff_t impacts = 0;
  std::ptrdiff_t right = 0;
  for (const SoundEvent &event : made.events())
    if (event.kind == SoundKind::impact) {
      impacts++;
      right += std::ranges::any_of(found, [&](Time at) {
        return std::chrono::abs(at - event.begin) <= std::chrono::milliseconds(20);
      });
    }
  ck_assert_int_ge(impacts, 15);
  ck_assert_int_ge(3 * right, 2 * impacts);
  ck_assert_int_le(std::ssize(found) - right, 3);
}

// Notes with hi-hats are no impacts.
CHECK_TEST(test_music)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2004, .seconds = 20, .impacts = false, .music = true });
  const auto found = onsets(analyze(render(made, 20, kTestRate, speakers), kTestRate, speakers));
  ck_assert_uint_le(found.size(), 1);
}

// What no sound has does no harm, and is forgotten.
CHECK_TEST(test_hostile)
{
  const auto mono = usual_speakers(1);
  SoundAnalyzer analyzer(kTestRate, mono);
  std::vector<float> frames(kTestRate / 2);
  const std::array<float, 5> hostile{ std::numeric_limits<float>::quiet_NaN(),
                                      std::numeric_limits<float>::infinity(),
                                      -std::numeric_limits<float>::infinity(),
                                      std::numeric_limits<float>::max(),
                                      std::numeric_limits<float>::denorm_min() };
  for (std::size_t i = 0; i < frames.size(); i++)
    frames[i] = hostile[i % hostile.size()];
  for (const Moment &moment : analyzer.add(frames, {}))
    fail_unless(moment.level >= 0 && moment.level <= 1);
  std::ranges::fill(frames, 0.0F);
  for (int i = 0; i < 8; i++)
    analyzer.add(frames, {});
  fail_unless_near(share_on(analyzer.add(frames, {})), 0, 1e-6);
  const auto felt = analyzer.add(tone(40, 0.1 * std::numbers::sqrt2, 2), {});
  fail_unless_near(felt.back().level, 0.75, 0.02);
}

// What no film means to be heard is silence: its powers would be numbers too small for the format,
// which cost three times as much.
CHECK_TEST(test_silence)
{
  Resampler resampler(kRate, 1);
  std::vector<float> frames(Resampler::kBlock);
  for (std::size_t i = 0; i < frames.size(); i++)
    frames[i] = i % 3 == 0 ? 1e-20F : -std::numeric_limits<float>::denorm_min();
  resampler.add(frames);
  float out = 1;
  int count = 0;
  for (; resampler.take({ &out, 1 }); count++)
    fail_unless(out == 0);
  ck_assert_int_ge(count, 900);
}

// After a reset everything is as at the start.
CHECK_TEST(test_reset)
{
  const auto speakers = usual_speakers(2);
  const SyntheticSound made({ .seed = 2005, .seconds = 4 });
  const auto frames = render(made, 4, kTestRate, speakers);
  SoundAnalyzer analyzer(kTestRate, speakers);
  const auto first = analyzer.add(frames, {});
  const std::vector<Moment> expected(first.begin(), first.end());
  fail_unless(!onsets(expected).empty());
  analyzer.reset();
  const auto again = analyzer.add(frames, {});
  ck_assert_uint_eq(again.size(), expected.size());
  for (std::size_t i = 0; i < again.size(); i++)
    fail_unless(again[i].level == expected[i].level && again[i].begin == expected[i].begin);
}

// A moment is known as soon as delay() after its end.
CHECK_TEST(test_delay)
{
  for (const int rate : { 8000, 44100, 48000, 192000 }) {
    SoundAnalyzer analyzer(rate, usual_speakers(1));
    const std::vector<float> frame(1);
    std::int64_t frames = 0;
    std::size_t known = 0;
    while (known == 0) {
      frames++;
      known = analyzer.add(frame, {}).size();
    }
    const Time heard(frames * 1'000'000'000 / rate);
    fail_unless(heard <= kHopTime + analyzer.delay());
    fail_unless(heard > kHopTime + analyzer.delay() - std::chrono::milliseconds(1));
  }
}

// An impact right after the start is none: too little is known of what was before.
CHECK_TEST(test_impact_at_the_start)
{
  const auto mono = usual_speakers(1);
  const SyntheticSound made({ .seed = 2006, .seconds = 4 });
  const std::vector<float> silence(kTestRate);
  std::vector<float> frames(kTestRate / 10);
  const Time begin = made.events().front().begin - std::chrono::milliseconds(30);
  made.render(kTestRate, begin.count() * kTestRate / 1'000'000'000, mono, frames);
  SoundAnalyzer analyzer(kTestRate, mono);
  analyzer.add(silence, {});
  ck_assert_uint_eq(onsets(analyzer.add(frames, {})).size(), 1);
  analyzer.add(silence, {});
  analyzer.reset();
  ck_assert_uint_eq(onsets(analyzer.add(frames, {})).size(), 0);
}

CHECK_MAIN(sound_analyzer)
