// SPDX-License-Identifier: LGPL-2.1-or-later
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "support/synth_harness.h"

#include "calibration/calibration.h"
#include "support/contains.h"
#include "support/peaking.h"
#include "support/spectrum.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"

#include "support/check_tests.h"

CHECK_TEST(test_channels)
{
  const Ones ones;
  // As many as there are cells, where downstream leaves it open.
  for (const int columns : { 1, 2, 3, 9, 33, 64 }) {
    const auto channels = static_cast<std::size_t>(columns);
    Harness synth(kPlain + ones.properties(), 1, columns, "audio/x-raw");
    std::vector<float> levels;
    for (std::size_t i = 0; i < channels; i++)
      levels.push_back(static_cast<float>(i + 1) / 64);
    synth.repeat(levels, 5);
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(synth.h->sinkpad);
    GstAudioInfo info;
    fail_unless(gst_audio_info_from_caps(&info, caps));
    ck_assert_int_eq(GST_AUDIO_INFO_CHANNELS(&info), columns);
    ck_assert_int_eq(GST_AUDIO_INFO_RATE(&info), kRate);
    fail_unless_equals_int(GST_AUDIO_INFO_IS_UNPOSITIONED(&info), columns > 2);
    fail_unless(!synth.said(GST_MESSAGE_INFO));
    for (std::size_t i = 0; i < channels; i++)
      fail_unless_near(synth.at(100 * GST_MSECOND, channels, i), levels[i], 1e-6);
  }
  // More than 64 cells share channels.
  Harness synth(kPlain + ones.properties(), 2, 64, "audio/x-raw");
  std::vector<float> levels(128, 0);
  levels[64 + 5] = 1;
  synth.repeat(levels, 5);
  for (std::size_t i = 0; i < 64; i++)
    fail_unless_near(synth.at(100 * GST_MSECOND, 64, i), i == 5 ? 1 : 0, 1e-6);
}

/// What channels play of a map of 3 × 3 whose cell i has the level (i + 1) / 10, in tenths.
static std::string
tenths(Harness &synth, std::size_t channels)
{
  std::vector<float> levels;
  for (int i = 0; i < 9; i++)
    levels.push_back(static_cast<float>(i + 1) / 10);
  synth.repeat(levels, 5);
  std::string text;
  for (std::size_t i = 0; i < channels; i++)
    text += std::to_string(std::lround(synth.at(100 * GST_MSECOND, channels, i) * 10)) + " ";
  return text;
}

CHECK_TEST(test_positions)
{
  const Ones ones;
  const struct
  {
    int channels;
    const char *mask;
    const char *expected;
  } cards[] = {
    { 1, "", "9 " },
    { 2, "", "8 9 " },                                         // left and right
    { 2, ",channel-mask=(bitmask)0x3", "8 9 " },               // the same
    { 3, ",channel-mask=(bitmask)0xb", "0 0 9 " },             // 2.1: LFE
    { 4, ",channel-mask=(bitmask)0x33", "0 0 8 9 " },          // DualSense: back left and right
    { 6, ",channel-mask=(bitmask)0x3f", "0 0 0 9 8 9 " },      // 5.1: LFE, back left and right
    { 8, ",channel-mask=(bitmask)0xc3f", "0 0 0 9 8 9 7 9 " }, // 7.1
    { 4, ",channel-mask=(bitmask)0x0", "7 8 9 9 " },
    { 12, "", "1 2 3 4 5 6 7 8 9 0 0 0 " },
  };
  for (const auto &card : cards) {
    Harness synth(kPlain + ones.properties(), 3, 3, sound_caps(card.channels, card.mask));
    assert_text(tenths(synth, static_cast<std::size_t>(card.channels)), card.expected);
    const std::optional<Said> said = synth.said(GST_MESSAGE_INFO);
    fail_unless(said.has_value());
    assert_text(said->text,
                card.channels == 1
                    ? "3 x 3 cells are felt on 1 channel."
                    : "3 x 3 cells are felt on " + std::to_string(card.channels) + " channels.");
    fail_unless(!synth.said(GST_MESSAGE_INFO)); // once
  }
}

CHECK_TEST(test_mapping)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties() + "mapping=1,-1,0,1,1,1,3,-1,-1", 3, 3, "audio/x-raw");
  assert_text(tenths(synth, 4), "3 6 0 7 ");
  fail_unless(!synth.said(GST_MESSAGE_WARNING));
  // One that does not fit is told, and not used.
  for (const char *mapping : { "1,0", "0,1,2,3,4,5,6,7,8" }) {
    Harness wrong(kPlain + ones.properties() + "mapping=" + mapping, 3, 3, sound_caps(2));
    assert_text(tenths(wrong, 2), "8 9 ");
    const std::optional<Said> said = wrong.said(GST_MESSAGE_WARNING);
    fail_unless(said.has_value());
    assert_contains(said->text, { "The mapping does not fit" });
    assert_contains(said->details, { "channel 0: 0,1,3,4,6,7; channel 1: 1,2,4,5,7,8" });
  }
}

CHECK_TEST(test_other_formats_are_refused)
{
  for (const char *caps : { "audio/x-raw,format=S16LE", "audio/x-raw,rate=4000",
                            "audio/x-raw,channels=65", "audio/x-raw,layout=non-interleaved" }) {
    Harness synth(kPlain, 1, 1, caps);
    fail_unless_equals_int(synth.push({ 1 }, 0), GST_FLOW_NOT_NEGOTIATED);
  }
}

CHECK_TEST(test_caps_change)
{
  const Ones ones;
  Harness synth(kPlain + ones.properties(), 1, 1, sound_caps(1));
  synth.repeat({ 1 }, 10);
  // The grid: the film goes on.
  gst_harness_set_src_caps_str(synth.h, map_caps(1, 2).c_str());
  synth.repeat({ 0, 0.5F }, 10);
  fail_unless_near(synth.at(500 * GST_MSECOND), 0.5, 1e-6);
  ck_assert_int_eq(synth.discontinuities, 1);
  // The sound: twice the rate and channels, from where it was.
  const GstClockTime changed = synth.next;
  synth.samples.clear();
  synth.first.reset();
  gst_harness_set_sink_caps_str(synth.h, sound_caps(2, ",rate=96000").c_str());
  synth.repeat({ 0, 0.5F }, 10);
  fail_unless_within(*synth.first, changed, 100 * GST_USECOND);
  fail_unless_equals_uint64(synth.next - *synth.first,
                            gst_util_uint64_scale(synth.samples.size() / 2, GST_SECOND, 96000));
  fail_unless_near(synth.samples.back(), 0.5, 1e-6);
  fail_unless_near(synth.samples[synth.samples.size() - 2], 0.0, 1e-6);
}

CHECK_TEST(test_calibration)
{
  // Channel 1 vibrates twice as much at the same volts, so that it gets half as many. Channel 0
  // takes 80 ms and 20 ms on the way, channel 1 40 ms, and channel 2 was not measured.
  const Ones ones;
  tactor::Calibration calibration;
  calibration.perception_exponent = 1;
  const auto tactor = [](double strength, double rise) {
    tactor::TactorCalibration made;
    made.start_volts = made.hold_volts = 0.1;
    made.vibration = { { 1.5, strength / 2 }, { 3, strength } };
    made.table
        = tactor::RiseTimeTable{ .step_volts = 3, .size = 2, .milliseconds = { 0, rise, 0, 0 } };
    return made;
  };
  calibration.tactors[0] = tactor(1, 80);
  calibration.tactors[0].table->milliseconds = { 80, 80, 80, 80 };
  calibration.tactors[0].latency = std::chrono::milliseconds(20);
  calibration.tactors[1] = tactor(2, 40);
  calibration.tactors[1].table->milliseconds = { 40, 40, 40, 40 };
  const TemporaryFile file;
  unwrap(tactor::write_calibration(calibration, file.path));
  Harness synth("tactilesynth rise-time=10000000 ramp-in=0 calibration=" + file.path + " "
                    + ones.properties(),
                1, 3, "audio/x-raw");
  synth.repeat({ 0, 0, 0 }, 10);
  synth.repeat({ 1, 1, 1 }, 10);
  synth.repeat({ 0, 0, 0 }, 10);
  const double amplitude[] = { 1, 0.5, 1 };
  const GstClockTime begins[] = { 300, 360, 390 };
  for (std::size_t channel = 0; channel < 3; channel++) {
    fail_unless_near(synth.at(600 * GST_MSECOND, 3, channel), amplitude[channel], 1e-3);
    GstClockTime when = 0;
    while (synth.at(when, 3, channel) < amplitude[channel] / 2)
      when += 100 * GST_USECOND;
    fail_unless_within(when, begins[channel] * GST_MSECOND, GST_MSECOND);
  }
}

/// The amplitude of a sine in a second of a channel, from 250 ms on.
static double
amplitude_of(const Harness &synth, std::size_t channels, std::size_t channel, std::size_t hertz)
{
  std::vector<float> own = channel_of(synth.samples, channels, channel);
  own.erase(own.begin(), own.begin() + kRate / 4);
  own.resize(kRate);
  return spectrum_of(own)[hertz];
}

CHECK_TEST(test_gain_and_equalizer)
{
  // Channel 0 has a gain, channel 1 an equalizer as well, and channel 2 no group. A square has all
  // odd harmonics: what the equalizer makes of each is known.
  const TemporaryFile file("[Calibration]\nversion=1\n"
                           "[Tactor 0]\ngain-db=-12\n"
                           "[Tactor 1]\ngain-db=-6\nequalizer-hz=60;180;\n"
                           "equalizer-db=-3;-9;\nequalizer-q=1;4;\n");
  Harness synth(kPlain + std::string("frequency=60 waveform=sine,square,sine calibration=")
                    + file.path,
                1, 3, sound_caps(3));
  synth.repeat({ 1, 0.5, 1 }, 40);
  synth.end();
  fail_unless(!synth.said(GST_MESSAGE_INFO)); // nothing is limited
  fail_unless_near(amplitude_of(synth, 3, 0, 60), std::pow(10, -12.0 / 20), 1e-4);
  fail_unless_near(amplitude_of(synth, 3, 2, 60), 1, 1e-4);
  const auto gain = [](double hertz) {
    return peaking(60, -3, 1, hertz) * peaking(180, -9, 4, hertz);
  };
  const double first = amplitude_of(synth, 3, 1, 60);
  for (const std::size_t h : { 3, 5, 7 })
    fail_unless_near(amplitude_of(synth, 3, 1, 60 * h) / first,
                     gain(60.0 * static_cast<double>(h)) / gain(60) / static_cast<double>(h), 1e-3);
  // Without a calibration, the same square at the same level.
  Harness plain(kPlain + std::string("frequency=60 waveform=square"), 1, 1, sound_caps(1));
  plain.repeat({ 0.5 }, 40);
  fail_unless_near(first / amplitude_of(plain, 1, 0, 60), std::pow(10, -6.0 / 20) * gain(60), 1e-3);
}

CHECK_TEST(test_calibration_without_rise_times)
{
  // A group of a gain alone is a shaker of rise-time's, and no coin motor.
  const Ones ones;
  const TemporaryFile file("[Calibration]\nversion=1\n[Tactor 0]\ngain-db=-6.0206\n");
  Harness synth("tactilesynth rise-time=100000000 ramp-in=0 calibration=" + file.path + " "
                    + ones.properties(),
                1, 1, sound_caps(1));
  synth.repeat({ 0 }, 10);
  synth.repeat({ 0.1F }, 10); // less than what starts a coin motor
  synth.end();
  fail_unless_near(synth.at(600 * GST_MSECOND), 0.05, 1e-4);
  fail_unless_within(synth.reaches(0.025F, 0), 300 * GST_MSECOND, GST_MSECOND);
}

CHECK_TEST(test_limiter)
{
  // Twice the amplitude: what a level of 0.8 would be beyond full scale is at full scale, whole.
  const TemporaryFile file("[Calibration]\nversion=1\n[Tactor 0]\n"
                           "equalizer-hz=60\nequalizer-db=6.0206\nequalizer-q=1\n");
  for (const auto &[level, expected] : { std::pair(0.25F, 0.5), { 0.8F, 1.0 } }) {
    Harness synth(kPlain + std::string("calibration=") + file.path, 1, 1, sound_caps(1));
    synth.repeat({ level }, 40);
    synth.end();
    fail_unless_near(amplitude_of(synth, 1, 0, 60), expected, 1e-3);
    fail_unless_at_most(
        strongest_outside(std::span(synth.samples).subspan(kRate / 4, kRate), kRate, 55, 65), -80);
    const std::optional<Said> said = synth.said(GST_MESSAGE_INFO);
    fail_unless(said.has_value());
    assert_contains(said->text, { "Stronger maps are limited" });
    assert_contains(said->details, { "full scale of channel 0 at 50 % of the strongest level" });
  }
}

/// A WAVE file of a sine, `rounds` in a loop of a second.
static std::string
sine_file(int rounds, double amplitude)
{
  constexpr int kFileRate = 8000;
  std::string bytes(
      "RIFF\0\0\0\0WAVEfmt \20\0\0\0\1\0\1\0\100\37\0\0\200\76\0\0\2\0\20\0data\200\76\0\0", 44);
  for (int i = 0; i < kFileRate; i++) {
    const double turn = 2 * std::numbers::pi * rounds * i / kFileRate;
    const auto value
        = static_cast<unsigned>(std::lround(32767 * amplitude * std::sin(turn))) & 0xffffU;
    bytes += static_cast<char>(value & 0xffU);
    bytes += static_cast<char>(value >> 8U);
  }
  return bytes;
}

CHECK_TEST(test_own_sample_of_each_channel)
{
  const TemporaryFolder folder;
  const std::string first = folder.file("first.wav", sine_file(40, 1));
  const std::string second = folder.file("second.wav", sine_file(70, 0.5));
  Harness synth(kPlain + std::string("frequency=55 waveform=sample,sine,sample sample=") + first
                    + ",," + second,
                1, 4, sound_caps(4));
  synth.repeat({ 1, 1, 1, 0.5 }, 40);
  synth.end();
  const double expected[][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0.5 }, { 0, 0, 0.25 } };
  for (std::size_t channel = 0; channel < 4; channel++)
    for (std::size_t i = 0; i < 3; i++)
      fail_unless_near(amplitude_of(synth, 4, channel, std::array{ 40, 55, 70 }[i]),
                       expected[channel][i], 1e-3);
  gst_harness_set(synth.h, "tactilesynth", "sample", nullptr, nullptr);
  g_autofree gchar *unset = nullptr;
  gst_harness_get(synth.h, "tactilesynth", "sample", &unset, nullptr);
  fail_unless(unset == nullptr);
}

CHECK_MAIN(tactilesynth_channels)
