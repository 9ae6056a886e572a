// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/equalizer.h"

#include "support/peaking.h"
#include "support/tolerance.h"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "support/check_tests.h"

using namespace synth;

namespace {

/// The amplitude of a round's harmonic, by its Fourier series.
double
harmonic(const Equalized &carrier, int number)
{
  const std::vector<float> &samples = carrier.wave->samples;
  const std::size_t count = samples.size() - 1;
  std::complex<double> sum;
  for (std::size_t i = 0; i < count; i++)
    sum += static_cast<double>(samples[i])
           * std::polar(1.0, -2 * std::numbers::pi * number * static_cast<double>(i)
                                 / static_cast<double>(count));
  return carrier.peak * 2 * std::abs(sum) / static_cast<double>(count);
}

double
peak_of(const Wave &wave)
{
  double peak = 0;
  for (const float sample : wave.samples)
    peak = std::max(peak, std::abs(static_cast<double>(sample)));
  return peak;
}

} // namespace

CHECK_TEST(test_sine)
{
  const std::vector<EqualizerBand> bands = { { 45, -9, 2 }, { 60, 12, 0.7 }, { 800, 6, 5 } };
  for (const double frequency : { 1.0, 20.0, 45.0, 60.0, 250.0, 800.0, 1000.0 })
    for (std::size_t count = 1; count <= bands.size(); count++) {
      double expected = 1;
      for (std::size_t i = 0; i < count; i++)
        expected *= peaking(bands[i].frequency, bands[i].gain, bands[i].q, frequency);
      const Equalized carrier
          = equalized(make_wave(Waveform::sine, frequency), std::span(bands).first(count));
      fail_unless_near(carrier.peak, expected, 1e-3 * expected);
      fail_unless_near(peak_of(*carrier.wave), 1, 1e-6);
      fail_unless_near(carrier.wave->frequency, frequency, 0);
    }
}

CHECK_TEST(test_each_harmonic)
{
  const EqualizerBand band = { 150, 12, 3 };
  const Equalized plain = equalized(make_wave(Waveform::square, 50), {});
  const Equalized carrier = equalized(make_wave(Waveform::square, 50), { &band, 1 });
  for (const int h : { 1, 3, 5, 7, 19 })
    fail_unless_near(harmonic(carrier, h) / harmonic(plain, h),
                     peaking(band.frequency, band.gain, band.q, 50.0 * h), 2e-3);
  fail_unless_near(harmonic(carrier, 2), 0, 1e-4);
}

CHECK_TEST(test_loop_of_few_samples)
{
  // A sine of 100 Hz in 20 samples of 2 kHz, less than the filter needs. Lines between samples have
  // less of the sine, and overtones far above the band.
  std::vector<float> loop;
  for (int i = 0; i < 20; i++)
    loop.push_back(static_cast<float>(0.5 * std::sin(2 * std::numbers::pi * i / 20)));
  const auto wave = std::make_shared<const Wave>(100, loop);
  const EqualizerBand band = { 100, 6, 4 };
  const Equalized carrier = equalized(wave, { &band, 1 });
  const double lines = std::pow(std::sin(std::numbers::pi / 20) / (std::numbers::pi / 20), 2);
  fail_unless_near(harmonic(carrier, 1), 0.5 * lines * std::pow(10, 6.0 / 20), 3e-3);
}

CHECK_TEST(test_settled)
{
  // A round and the same twice in a round of half the frequency are one sound. So a round begins as
  // it ends, however long the filter rings.
  std::mt19937 any(5);
  std::vector<float> once;
  for (int i = 0; i < 1000; i++)
    once.push_back(static_cast<float>(any()) / 4294967296.0F - 0.5F);
  std::vector<float> twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  const std::vector<EqualizerBand> bands = { { 7, 24, 20 }, { 500, -24, 0.1 } };
  const Equalized one = equalized(std::make_shared<const Wave>(16, once), bands);
  const Equalized two = equalized(std::make_shared<const Wave>(8, twice), bands);
  fail_unless_near(one.peak, two.peak, 1e-6);
  for (std::size_t i = 0; i < two.wave->samples.size(); i++)
    fail_unless_near(two.wave->samples[i], one.wave->samples[i % (one.wave->samples.size() - 1)],
                     1e-6);
}

CHECK_TEST(test_dip_undoes_peak)
{
  const auto noise = make_wave(Waveform::noise, 60);
  const std::vector<EqualizerBand> bands = { { 70, 12, 8 }, { 70, -12, 8 } };
  const Equalized raised = equalized(noise, std::span(bands).first(1));
  fail_unless(raised.peak > 1.2);
  const Equalized same = equalized(noise, bands);
  fail_unless_near(same.peak, 1, 1e-6);
  for (std::size_t i = 0; i < noise->samples.size(); i++)
    fail_unless_near(same.wave->samples[i], noise->samples[i], 1e-5);
}

CHECK_TEST(test_without_bands)
{
  const auto sine = make_wave(Waveform::sine, 60);
  fail_unless(equalized(sine, {}).wave == sine);
  // A quiet loop gets full scale, and says by how much.
  const auto quiet = std::make_shared<const Wave>(10, std::vector<float>{ 0, 0.25F, -0.5F });
  const Equalized carrier = equalized(quiet, {});
  fail_unless((carrier.wave->samples == std::vector<float>{ 0, 0.5F, -1, 0 }));
  fail_unless_near(carrier.peak, 0.5, 1e-9);
  const EqualizerBand band;
  const Equalized silent
      = equalized(std::make_shared<const Wave>(10, std::vector<float>{ 0, 0 }), { &band, 1 });
  fail_unless_near(silent.peak, 0, 0);
  fail_unless_near(peak_of(*silent.wave), 0, 0);
}

CHECK_MAIN(equalizer)
