// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sound/voicing.h"

#include <cmath>
#include <numbers>
#include <random>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using sound::Voicing;

namespace {

constexpr int kHop = 80;

/// The least and the most of a second, from 0.1 s on.
struct Range
{
  double least = 1;
  double most = 0;
};

template <typename Sample>
Range
heard(Voicing &voicing, Sample sample)
{
  Range range;
  for (int i = 0; i < sound::kRate; i++) {
    voicing.add(sample(i));
    if (i % kHop < kHop - 1)
      continue;
    const double now = voicing.take();
    if (i < sound::kRate / 10)
      continue;
    range.least = std::min(range.least, now);
    range.most = std::max(range.most, now);
  }
  return range;
}

/// As of a larynx: all partials up to 4 kHz, 6 dB less an octave.
double
buzz(double hz, int i)
{
  double sum = 0;
  for (int n = 1; n * hz < 4000; n++)
    sum += std::sin(2 * std::numbers::pi * n * hz * i / sound::kRate) / n;
  return 0.1 * sum;
}

} // namespace

// Of any pitch that voices have, as loud as a whisper, too.
CHECK_TEST(test_pitches)
{
  for (const double hz : { 71.0, 90.0, 123.4, 200.0, 314.0, 399.0 })
    for (const double factor : { 1.0, 0.05 }) {
      Voicing voicing;
      const Range range = heard(voicing, [&](int i) { return factor * buzz(hz, i); });
      fail_unless(range.least > 0.8, "%g Hz: %g", hz, range.least);
      fail_unless(range.most <= 1);
    }
}

// Noise has no period, two notes that agree in none have little of one, silence has nothing.
CHECK_TEST(test_others)
{
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  Voicing voicing;
  fail_unless(heard(voicing, [&](int) { return normal(random); }).most < 0.8);
  const Range chord = heard(voicing, [](int i) { return buzz(233.1, i) + buzz(329.6, i); });
  fail_unless(chord.least < 0.8, "%g", chord.least);
  fail_unless(heard(voicing, [](int) { return 0.0; }).most < 1e-3);
  fail_unless(heard(voicing, [&](int i) { return 1e-5 * buzz(120, i); }).most < 0.1);
  // What was before is forgotten.
  voicing.reset();
  fail_unless(voicing.take() < 1e-9);
}

CHECK_MAIN(voicing)
