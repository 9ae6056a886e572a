// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/synthesizer.h"

#include "support/spectrum.h"
#include "support/tolerance.h"

#include <algorithm>
#include <random>

#include "support/check_tests.h"

using namespace synth;

namespace {

constexpr int kRate = 48000;
constexpr int kRamp = 576; ///< 12 ms

/// What a ramp may be heard of beyond the carrier, in Hz.
constexpr double kSideband = 200;

Voice
voice(Waveform waveform = Waveform::sine, double frequency = 60)
{
  return { make_wave(waveform, frequency) };
}

std::vector<float>
render(Synthesizer &synthesizer, std::size_t frames, std::size_t channels = 1)
{
  std::vector<float> samples(frames * channels);
  synthesizer.render(samples);
  return samples;
}

/// A second at full amplitude, after the ramp.
std::vector<float>
steady(Waveform waveform, double frequency, int rate = kRate)
{
  Synthesizer synthesizer(rate, { voice(waveform, frequency) }, kRamp);
  synthesizer.change(0, 1);
  render(synthesizer, kRamp);
  return render(synthesizer, static_cast<std::size_t>(rate));
}

double
peak_of(std::span<const float> samples)
{
  double peak = 0;
  for (const float sample : samples)
    peak = std::max(peak, std::abs(static_cast<double>(sample)));
  return peak;
}

} // namespace

CHECK_TEST(test_sine)
{
  for (const int rate : { 8000, 44100, 48000, 192000 })
    for (const double frequency : { 20.0, 60.0, 250.0, 1000.0 }) {
      const std::vector<float> sound = steady(Waveform::sine, frequency, rate);
      const std::vector<double> spectrum = spectrum_of(sound); // bins of 1 Hz
      fail_unless_near(spectrum[static_cast<std::size_t>(frequency)], 1, 1e-4);
      fail_unless_at_most(strongest_outside(sound, rate, frequency - 5, frequency + 5), -85);
    }
}

CHECK_TEST(test_harmonics)
{
  const double pi = std::numbers::pi;
  const std::vector<double> square = spectrum_of(steady(Waveform::square, 50));
  const std::vector<double> triangle = spectrum_of(steady(Waveform::triangle, 50));
  for (std::size_t h = 1; h <= 19; h++) {
    // Fourier series; those of the square are scaled, for its overshoot, by the same factor.
    const double odd = h % 2 == 1 ? 1.0 : 0.0;
    const double harmonic = static_cast<double>(h);
    fail_unless_near(square[50 * h] / square[50], odd / harmonic, 1e-4);
    fail_unless_near(triangle[50 * h], odd * 8 / (pi * pi) / (harmonic * harmonic), 0.03 / h);
  }
  for (const Waveform waveform : { Waveform::square, Waveform::triangle }) {
    const std::vector<float> sound = steady(waveform, 50);
    fail_unless_at_most(strongest_outside(sound, kRate, 0, 1005), -85);
    fail_unless_near(peak_of(sound), 1, 1e-3);
  }
}

CHECK_TEST(test_noise)
{
  const std::vector<float> sound = steady(Waveform::noise, 80);
  fail_unless_at_most(strongest_outside(sound, kRate, 80 / 1.414 - 6, 80 * 1.414 + 6), -80);
  fail_unless_at_most(peak_of(sound), 1);
  // All over its octave: each band of 10 Hz within 6 dB of the mean.
  const std::vector<double> spectrum = spectrum_of(sound);
  double sum = 0;
  std::vector<double> bands;
  for (std::size_t low = 60; low < 110; low += 10) {
    double power = 0;
    for (std::size_t i = low; i < low + 10; i++)
      power += spectrum[i] * spectrum[i];
    bands.push_back(power);
    sum += power / 5;
  }
  for (const double power : bands)
    fail_unless(power > sum / 4 && power < sum * 4);
}

CHECK_TEST(test_own_loop)
{
  // A period of four samples, played at a quarter of its rate: linear between them.
  const std::vector<float> loop = { 0, 1, 0, -2 };
  Synthesizer synthesizer(kRate, { { std::make_shared<const Wave>(kRate / 16.0, loop) } }, 1);
  synthesizer.change(0, 1);
  const std::vector<float> sound = render(synthesizer, 17);
  const std::vector<float> expected = { 0,     0.25F, 0.5F,  0.75F, 1,      0.75F, 0.5F,   0.25F, 0,
                                        -.25F, -0.5F, -.75F, -1,    -0.75F, -0.5F, -0.25F, 0 };
  for (std::size_t i = 1; i < expected.size(); i++) // the first is in the ramp
    fail_unless_near(sound[i], expected[i], 1e-5);
}

CHECK_TEST(test_ramps_do_not_click)
{
  // Up and down within a window of 171 ms, at several phases of the carrier, also while others are
  // under way.
  for (const double frequency : { 60, 250 })
    for (const std::size_t at : { 2000, 2100, 2222, 2345, 2400 })
      for (const std::size_t between : { 1900, 481, 300, 77 }) {
        Synthesizer synthesizer(kRate, { voice(Waveform::sine, frequency) }, kRamp);
        std::vector<float> sound = render(synthesizer, at);
        const auto add = [&](float amplitude, std::size_t frames) {
          synthesizer.change(0, amplitude);
          const std::vector<float> more = render(synthesizer, frames);
          sound.insert(sound.end(), more.begin(), more.end());
        };
        add(1, between);
        add(0, between);
        add(0.7F, between);
        add(0.2F, 8192 - sound.size());
        fail_unless_at_most(
            strongest_outside(sound, kRate, frequency - kSideband, frequency + kSideband), -60);
      }
}

CHECK_TEST(test_step_of_one_sample_clicks)
{
  // What the test above would find without ramps.
  Synthesizer synthesizer(kRate, { voice() }, 1);
  std::vector<float> sound = render(synthesizer, 4200); // at a peak of the carrier
  synthesizer.change(0, 1);
  const std::vector<float> more = render(synthesizer, 3992);
  sound.insert(sound.end(), more.begin(), more.end());
  fail_unless(strongest_outside(sound, kRate, -1, 60 + kSideband) > -45);
}

CHECK_TEST(test_half_way_in_the_middle)
{
  // A carrier of 1: the samples are the amplitude.
  const auto one = std::make_shared<const Wave>(1, std::vector<float>{ 1 });
  Synthesizer synthesizer(kRate, { { one, 0, 0.5F } }, kRamp);
  synthesizer.change(0, 0.8F);
  std::vector<float> sound = render(synthesizer, 2 * kRamp);
  for (std::size_t i = 0; i < sound.size(); i++) {
    const double x = std::min((static_cast<double>(i) + 0.5) / kRamp, 1.0);
    fail_unless_near(sound[i],
                     0.5 * 0.8 * (x - std::sin(2 * std::numbers::pi * x) / (2 * std::numbers::pi)),
                     1e-6);
  }
  fail_unless_near(sound[kRamp / 2 - 1] + sound[kRamp / 2], 0.4, 1e-6);
  // Back to zero, exactly, after many small changes.
  for (int i = 0; i < 5000; i++) {
    synthesizer.change(0, 0.1F + 0.7F * static_cast<float>(i % 7) / 7);
    render(synthesizer, 100);
  }
  synthesizer.change(0, 0);
  render(synthesizer, 5000);
  fail_unless(synthesizer.is_silent());
  fail_unless_equals_float(peak_of(render(synthesizer, 100)), 0);
}

CHECK_TEST(test_phase_goes_on)
{
  // Through silence, a change and a skip, the carrier is that of the time.
  Synthesizer synthesizer(kRate, { voice(Waveform::sine, 37) }, kRamp);
  synthesizer.change(0, 1);
  render(synthesizer, 1000);
  synthesizer.change(0, 0);
  render(synthesizer, 1234);
  fail_unless(synthesizer.is_silent());
  synthesizer.skip(987654321);
  synthesizer.change(0, 1);
  render(synthesizer, kRamp);
  const std::vector<float> sound = render(synthesizer, 1000);
  const std::int64_t first = 1000 + 1234 + 987654321 + kRamp;
  for (std::size_t i = 0; i < sound.size(); i++) {
    const double rounds = static_cast<double>((first + static_cast<std::int64_t>(i)) * 37 % kRate);
    fail_unless_near(sound[i], std::sin(2 * std::numbers::pi * rounds / kRate), 1e-5);
  }
}

/// Two seconds with a change each 20 ms, rendered in parts of `part` samples, or of any size.
static std::vector<float>
in_parts(std::size_t channels, std::size_t part)
{
  std::vector<Voice> voices;
  for (std::size_t c = 0; c < channels; c++)
    voices.push_back({ make_wave(Waveform::sine, 20 + 3 * static_cast<double>(c)), 0.1 * c,
                       1 / (1 + static_cast<float>(c)) });
  Synthesizer synthesizer(kRate, voices, kRamp);
  synthesizer.arm(4800);
  std::mt19937 any(7);
  std::vector<float> samples(channels * 2 * kRate);
  std::span<float> left(samples);
  for (int i = 0; i < 100; i++) {
    for (std::size_t c = 0; c < channels; c++)
      synthesizer.change(c, static_cast<float>((i * 7 + c * 3) % 11) / 10);
    for (std::size_t frames = 960; frames > 0;) {
      const std::size_t count = std::min(frames, part > 0 ? part : 1 + any() % 300);
      synthesizer.render(left.first(count * channels));
      left = left.subspan(count * channels);
      frames -= count;
    }
  }
  return samples;
}

CHECK_TEST(test_same_in_parts)
{
  for (const std::size_t channels : { 1, 2, 9, 64 }) {
    const std::vector<float> whole = in_parts(channels, 960);
    fail_unless(peak_of(whole) > 0.3);
    for (const std::size_t part : { 1, 127, 512, 0 })
      fail_unless(in_parts(channels, part) == whole);
  }
}

CHECK_TEST(test_never_beyond_full_scale)
{
  // More changes at once than there are ramps, of any size, also of no number.
  std::mt19937 any(3);
  Synthesizer synthesizer(kRate, { voice(Waveform::square, 20), voice(Waveform::noise, 100) },
                          kRamp);
  double peak = 0;
  for (int i = 0; i < 20000; i++) {
    const float levels[] = { 0, 1, 0.3F, 7, -3, std::nanf("") };
    synthesizer.change(i % 2, levels[any() % 6]);
    const std::vector<float> sound = render(synthesizer, any() % 20, 2);
    for (const float sample : sound)
      fail_unless(std::isfinite(sample));
    peak = std::max(peak, peak_of(sound));
  }
  fail_unless_at_most(peak, 1);
  fail_unless(peak > 0.5);
  // The one that waited is reached.
  synthesizer.change(0, 0);
  synthesizer.change(1, 0);
  render(synthesizer, 2 * kRamp, 2);
  fail_unless(synthesizer.is_silent());
}

CHECK_TEST(test_limiter)
{
  // Beyond full scale it is full scale: nothing is clipped.
  Voice raised = voice();
  raised.gain = 2;
  for (const auto &[amplitude, expected] :
       { std::pair(0.25F, 0.5), { 0.5F, 1.0 }, { 0.9F, 1.0 } }) {
    Synthesizer synthesizer(kRate, { raised }, kRamp);
    synthesizer.change(0, amplitude);
    render(synthesizer, kRamp);
    const std::vector<float> sound = render(synthesizer, kRate);
    fail_unless_near(spectrum_of(sound)[60], expected, 1e-4);
    fail_unless_at_most(strongest_outside(sound, kRate, 55, 65), -85);
  }
  // A change to beyond full scale has the ramp of one to full scale.
  Synthesizer synthesizer(
      kRate, { { std::make_shared<const Wave>(1, std::vector<float>{ 1 }), 0, 4 } }, kRamp);
  synthesizer.change(0, 1);
  fail_unless_near(render(synthesizer, kRamp / 2).back(), 0.5, 1e-2);
}

CHECK_TEST(test_soft_start)
{
  const auto one = std::make_shared<const Wave>(1, std::vector<float>{ 1 });
  Synthesizer synthesizer(kRate, { { one }, { one } }, 1);
  synthesizer.arm(4800);
  fail_unless_equals_float(peak_of(render(synthesizer, 1000, 2)), 0); // it waits for a vibration
  synthesizer.change(1, 1);
  const std::vector<float> sound = render(synthesizer, 6000, 2);
  for (std::size_t i = 1; i < 6000; i++) {
    fail_unless_near(sound[2 * i + 1], std::min(i / 4800.0, 1.0), 1e-6);
    fail_unless_equals_float(sound[2 * i], 0);
  }
  // The next one is not soft.
  synthesizer.change(0, 1);
  fail_unless_near(render(synthesizer, 2, 2)[2], 1, 1e-6);
}

CHECK_MAIN(synthesizer)
