// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What tests/sound/train.py learns lib/sound/onset_weights.h from: a line for each moment at which
// an impact may begin.
//
// Usage: sound_features SEED SPEECH.wav ... >FEATURES.csv     (16-bit mono)
// SEED: of the first sound. Those that follow are below SEED + 1000.
// Columns: class (notes, voices), impact (its number, 0 if none is near), seconds, features
#include "onsets.h"
#include "speech.h"

#include "sound/onset_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>

using namespace judged;
using sound::SoundSettings;
using sound::SyntheticSound;

namespace {

constexpr std::uint64_t kFilms = 10;
constexpr double kSeconds = 60;
/// From 16 kHz up the analysis is the same at any rate. Some films are at kNarrowRate.
constexpr int kTrainRate = 22050;
constexpr int kNarrowRate = 8000;
constexpr std::uint64_t kNarrowFilms = 2;
/// A moment so close to an impact's begin may stand for it, s.
constexpr double kNear = 0.0151;
/// One that is closer than this, before or after, is neither an impact nor none, s.
constexpr double kBefore = 0.04;
constexpr double kAfter = 0.1;

std::uint64_t first_seed = 0;
int impacts = 0;

void
write(const char *of, std::span<const float> frames, int rate, int channels,
      std::span<const double> truth)
{
  sound::Bands bands(rate, sound::usual_speakers(channels));
  sound::OnsetFeatures features;
  sound::BandPowers powers;
  int hop = 0;
  const std::size_t block = sound::Resampler::kBlock * static_cast<std::size_t>(channels);
  for (std::size_t at = 0; at < frames.size(); at += block) {
    bands.add(frames.subspan(at, std::min(block, frames.size() - at)));
    while (bands.next(powers)) {
      const double seconds = 0.005 * (hop++ - sound::OnsetFeatures::kAhead);
      if (!features.add(powers))
        continue;
      const auto close = std::ranges::find_if(truth, [&](double begin) {
        return seconds > begin - kBefore && seconds < begin + kAfter;
      });
      int impact = 0;
      if (close != truth.end()) {
        if (std::abs(seconds - *close) > kNear)
          continue;
        impact = impacts + 1 + static_cast<int>(close - truth.begin());
      }
      std::printf("%s,%d,%.3f", of, impact, seconds);
      for (const double feature : features.features())
        std::printf(",%.3f", feature);
      std::printf("\n");
    }
  }
  impacts += static_cast<int>(truth.size());
}

/// Impacts and explosions, alone and in music; music.
void
notes()
{
  for (std::uint64_t film = 0; film < kFilms; film++) {
    SoundSettings settings{ .seed = first_seed + film, .seconds = kSeconds };
    const auto add = [&] {
      const int rate = film < kNarrowFilms ? kNarrowRate : kTrainRate;
      const SyntheticSound made(settings);
      write("notes", rendered(made, kSeconds, rate, sound::usual_speakers(2)), rate, 2,
            impacts_of(made));
      settings.seed += 100;
    };
    add();
    settings.music = true;
    for (const double ratio : { 6.0, 0.0, 0.0, -6.0 }) {
      settings.impacts_db = settings.music_db + ratio;
      add();
    }
    settings.impacts = false;
    add();
    add();
    settings.explosions = true;
    add();
    settings.music = false;
    add();
  }
}

/// As close to a microphone: 9 dB more below 150 Hz.
std::vector<float>
made_close(std::span<const float> speech, int rate)
{
  constexpr double kMore = 1.8;
  const double part = 1 - std::exp(-2 * std::numbers::pi * 150 / rate);
  std::vector<float> result(speech.begin(), speech.end());
  double low = 0;
  for (float &sample : result) {
    low += part * (static_cast<double>(sample) - low);
    sample += static_cast<float>(kMore * low);
  }
  return result;
}

std::vector<float>
mixed(std::span<const float> sound, std::span<const float> other, double other_db)
{
  const auto factor = static_cast<float>(std::pow(10, other_db / 20));
  std::vector<float> result(sound.begin(), sound.end());
  for (std::size_t i = 0; i < result.size(); i++)
    result[i] += factor * other[i];
  return result;
}

/// White, at 0 dB of full scale.
std::vector<float>
noise(std::size_t samples, std::uint64_t seed)
{
  std::mt19937_64 random(seed);
  std::vector<float> result(samples);
  for (float &sample : result)
    sample = static_cast<float>(static_cast<double>(random() >> 11U) * 0x1p-52 - 1) * 1.732F;
  return result;
}

/// A voice alone, in noise, in rumble, over music; impacts while somebody talks.
void
voice(const Speech &speech, std::uint64_t seed)
{
  const std::vector<float> &alone = speech.samples;
  const double seconds = static_cast<double>(alone.size()) / speech.rate;
  const std::vector<float> near = made_close(alone, speech.rate);
  const std::vector<float> white = noise(alone.size(), seed);
  const auto add = [&](std::span<const float> frames, std::span<const double> truth = {}) {
    write("voices", frames, speech.rate, 1, truth);
  };
  SoundSettings settings{ .seed = first_seed + seed, .seconds = seconds, .impacts = false };
  const auto made = [&] {
    std::vector<float> frames(alone.size());
    SyntheticSound(settings).render(speech.rate, 0, sound::usual_speakers(1), frames);
    return frames;
  };
  add(alone);
  add(near);
  add(mixed(alone, white, -60));
  add(mixed(alone, white, -50));
  add(mixed(near, white, -40));
  add(mixed(near, white, -30));
  settings.rumble = true;
  add(mixed(alone, made(), -10));
  settings.rumble = false;
  settings.music = true;
  const std::vector<float> music = made();
  for (const double db : { 0.0, -10.0, -20.0 })
    add(mixed(alone, music, db));
  settings.music = false;
  settings.impacts = true;
  for (const double db : { -14.0, -20.0 }) {
    settings.seed += 100;
    settings.impacts_db = db;
    add(mixed(mixed(alone, made(), 0), white, -55), impacts_of(SyntheticSound(settings)));
  }
}

} // namespace

int
main(int argc, char **argv)
{
  if (argc < 2) {
    std::fputs("Usage: sound_features SEED SPEECH.wav ...\n", stderr);
    return 2;
  }
  first_seed = std::strtoull(argv[1], nullptr, 10);
  notes();
  for (int i = 2; i < argc; i++) {
    const Speech speech = read_speech(argv[i]);
    if (speech.samples.empty()) {
      std::fprintf(stderr, "%s: expected a WAV file with 16-bit samples\n", argv[i]);
      return 1;
    }
    voice(speech, static_cast<std::uint64_t>(i - 1));
  }
  return 0;
}
