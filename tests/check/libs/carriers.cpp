// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/carriers.h"

#include "support/contains.h"
#include "support/tolerance.h"
#include "support/unwrap.h"

#include <algorithm>

#include "support/check_tests.h"

using namespace synth;

CHECK_TEST(test_lists)
{
  fail_unless((unwrap(read_numbers(" 40 , 62.5", 1, 1000)) == std::vector<double>{ 40, 62.5 }));
  assert_text(write_numbers(std::vector{ 40, 62.5 }), "40,62.5");
  fail_unless(
      (unwrap(read_waveforms("noise, sine")) == std::vector{ Waveform::noise, Waveform::sine }));
  assert_text(write_waveforms(unwrap(read_waveforms("sample,square,triangle"))),
              "sample,square,triangle");
}

CHECK_TEST(test_refused)
{
  for (const char *text : { "", "0.5", "1001", "nan", "40,", "40;60", "60Hz", "-60" })
    assert_contains(refusal_of(read_numbers(text, 1, 1000)),
                    { "expected 1 to 1000 for each channel, with commas, as in 40,60" });
  assert_contains(refusal_of(read_numbers("40,,60", 1, 1000)), { "entry 2 is ''" });
  assert_contains(refusal_of(read_waveforms("sine,Sine")),
                  { "entry 2 is 'Sine'; expected sine,triangle,square,noise,sample for each" });
  assert_contains(refusal_of(read_numbers(std::string(100000, ','), 1, 2)), { "entry 1" });
  std::string long_list = "1";
  for (int i = 0; i < 5000; i++)
    long_list += ",1";
  assert_contains(refusal_of(read_numbers(long_list, 1, 2)), { "entry 4097" });
}

CHECK_TEST(test_voices)
{
  const auto loop = std::make_shared<const Wave>(5, std::vector<float>{ 0, 1 });
  const Carriers carriers{ .frequencies = { 40, 60 },
                           .waveforms = { Waveform::sine, Waveform::sample, Waveform::noise },
                           .gains = { 0.5, 1 },
                           .samples = { nullptr, loop } };
  const std::vector<Voice> voices = carriers.voices(64);
  ck_assert_int_eq(voices.size(), 64);
  fail_unless_near(voices[0].wave->frequency, 40, 1e-9);
  fail_unless(voices[1].wave == loop);
  fail_unless(voices[2].wave == voices[63].wave);
  fail_unless_near(voices[0].gain, 0.5, 1e-9);
  fail_unless_near(voices[63].gain, 1, 1e-9);
  // No two of the same noise within 5 ms.
  for (std::size_t i = 2; i < 64; i++)
    for (std::size_t j = 2; j < i; j++) {
      const double apart = voices[i].phase - voices[j].phase;
      fail_unless(std::abs(apart - std::round(apart)) > 0.005);
    }
}

CHECK_TEST(test_tunings)
{
  const auto quiet = std::make_shared<const Wave>(5, std::vector<float>{ 0, 0.5F });
  const EqualizerBand band = { 60, -20, 1 };
  const Carriers carriers{ .waveforms = { Waveform::sine, Waveform::sine, Waveform::sample },
                           .gains = { 0.5 },
                           .samples = { nullptr, nullptr, quiet },
                           .tunings = { { .equalizer = { band } }, {}, { .gain = 4 } } };
  const std::vector<Voice> voices = carriers.voices(4);
  fail_unless_near(voices[0].gain, 0.5 * 0.1, 1e-4);
  fail_unless_near(voices[1].gain, 0.5, 1e-6);
  fail_unless_near(voices[2].gain, 0.5 * 4 * 0.5, 1e-6); // of a loop at half of full scale
  fail_unless_near(voices[2].wave->samples[1], 1, 1e-6);
  fail_unless_near(voices[3].gain, 0.5 * 0.5, 1e-6); // not measured
}

/// The strongest sample of a second at a frequency.
static float
peak_at(const Carriers &carriers, double frequency)
{
  Synthesizer synthesizer(8000, carriers.voices(1), 8);
  synthesizer.change(0, 0.5F);
  synthesizer.tune(0, frequency);
  std::vector<float> sound(8000);
  synthesizer.render(sound);
  return *std::max_element(sound.begin() + 100, sound.end());
}

CHECK_TEST(test_tuned)
{
  // The equalizer is that of the frequency: its gain in its middle, none far away.
  const EqualizerBand band = { 240, -20, 5 };
  for (const auto &[frequency, gain] : { std::pair(240.0, 0.1), { 20.0, 1.0 }, { 0.0, 1.0 } })
    fail_unless_near(peak_at({ .frequencies = { 30 }, .tunings = { { 1, { band } } } }, frequency),
                     0.5 * gain, 0.002);
  // Only a sine can be played at another frequency.
  const auto loop = std::make_shared<const Wave>(1, std::vector<float>{ 0, 1, 0, -1 });
  const Carriers others{ .waveforms = { Waveform::square, Waveform::triangle, Waveform::noise,
                                        Waveform::sample },
                         .samples = { loop } };
  Synthesizer own(8000, others.voices(4), 8);
  Synthesizer tuned(8000, others.voices(4), 8);
  std::vector<float> expected(8000);
  std::vector<float> sound(8000);
  for (std::size_t i = 0; i < 4; i++) {
    own.change(i, 1);
    tuned.change(i, 1);
    tuned.tune(i, 500);
  }
  own.render(expected);
  tuned.render(sound);
  fail_unless(sound == expected);
}

CHECK_TEST(test_names)
{
  for (const char *text : { "", "purr.wav", "a b.wav,,c.wav", ",b.wav" })
    assert_text(write_names(unwrap(read_names(text))), text);
  fail_unless((unwrap(read_names("a.wav, b.wav")) == std::vector<std::string>{ "a.wav", "b.wav" }));
  assert_contains(refusal_of(read_names(std::string(5000, ','))), { "entry 4097" });
}

CHECK_MAIN(carriers)
