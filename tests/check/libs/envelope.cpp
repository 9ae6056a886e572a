// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/envelope.h"
#include "calibration/mains_hum.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "support/tolerance.h"

#include "support/check_tests.h"

using namespace tactor;

namespace {

constexpr double kRate = 2000;

double
wave(double hz, double at, double phase = 0)
{
  return std::sin(2 * std::numbers::pi * hz * at + phase);
}

std::vector<double>
sampled(const std::function<double(double)> &function, double seconds = 2)
{
  std::vector<double> samples(static_cast<std::size_t>(seconds * kRate));
  for (std::size_t i = 0; i < samples.size(); i++)
    samples[i] = function(static_cast<double>(i) / kRate);
  return samples;
}

} // namespace

// The envelope of a tone with slowly changing amplitude is that amplitude.
CHECK_TEST(envelope_of_a_modulated_tone_is_the_modulation)
{
  const auto swell = [](double at) {
    return 1 + 0.5 * wave(3, at);
  };
  const std::vector<double> tone = sampled([&](double at) { return swell(at) * wave(77, at, 1); });
  const std::vector<double> amplitude = envelope(tone, kRate, { 20, 200 });
  for (std::size_t i = 400; i < 3600; i++)
    fail_unless_near(amplitude[i], swell(static_cast<double>(i) / kRate), 0.005);
}

CHECK_TEST(band_pass_keeps_the_band_in_phase_and_nothing_else)
{
  const std::vector<double> mixed
      = sampled([](double at) { return 5 + 3 * at + wave(77, at) + wave(5, at) + wave(600, at); });
  const std::vector<double> passed = band_pass(mixed, kRate, { 20, 200 });
  for (std::size_t i = 600; i < 3400; i++)
    fail_unless_near(passed[i], wave(77, static_cast<double>(i) / kRate), 0.05);
}

CHECK_TEST(empty_signal_has_no_envelope)
{
  fail_unless(envelope({}, kRate, {}).empty());
  fail_unless(band_pass({}, kRate, {}).empty());
  fail_unless(strongest_frequency({}, kRate) == 0);
  const std::vector<double> silence(1000, 0.0);
  fail_unless(strongest_frequency(silence, kRate) == 0);
  for (const double amplitude : envelope(silence, kRate, {}))
    fail_unless(amplitude == 0);
}

CHECK_TEST(strongest_line_is_found)
{
  const std::vector<double> tones
      = sampled([](double at) { return wave(77, at) + 0.5 * wave(50, at) + 4 * wave(2, at); });
  fail_unless_near(strongest_frequency(tones, kRate), 77, 0.6);
}

// Hum is a little off the mains frequency, and the motor vibrates near it. Only the hum is removed.
CHECK_TEST(hum_is_taken_out_and_the_motor_is_not)
{
  for (const double mains : { 50.07, 59.9 }) {
    const auto motor = [](double at) {
      return at > 0.6 && at < 1.4 ? wave(52, at) : 0;
    };
    std::vector<double> heard = sampled([&](double at) {
      return motor(at) + 0.3 * wave(mains, at, 2) + 0.1 * wave(2 * mains, at)
             + 0.1 * wave(3 * mains, at, 1);
    });
    std::vector<bool> rests(heard.size());
    for (std::size_t i = 0; i < rests.size(); i++)
      rests[i] = i < 1200 || i >= 2800;
    const double hum = remove_mains_hum(heard, rests, kRate, 200);
    fail_unless_near(hum, std::sqrt((0.09 + 0.01 + 0.01) / 2), 0.01);
    for (std::size_t i = 0; i < heard.size(); i++)
      fail_unless_near(heard[i], motor(static_cast<double>(i) / kRate), 0.02);
  }
}

CHECK_TEST(noise_is_no_hum)
{
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  std::vector<double> heard = sampled([&](double) { return noise(random); });
  const std::vector<double> before = heard;
  fail_unless(remove_mains_hum(heard, std::vector<bool>(heard.size(), true), kRate, 200) == 0);
  fail_unless(heard == before);
}

CHECK_MAIN(envelope)
