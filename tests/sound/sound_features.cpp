// SPDX-License-Identifier: LGPL-2.1-or-later
//
// What tests/sound/train.py learns from: 16 kHz, mono, raw 32-bit floats in; on standard output a
// row of 32-bit floats for each moment: its hop's number and its features. Without a sound: how
// many these are.
//
// Usage: sound_features impacts|rumble [SOUND.f32]
//        sound_features make SEED impacts|explosions|music|impacts+0|impacts+6 MADE.f32
//
// The second writes a minute of synthetic sound, with music if a ratio in dB is given, and prints
// its impacts' seconds.
#include "sound/onset_features.h"
#include "sound/rumble_features.h"
#include "sound/synthetic_sound.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

using Onset = sound::OnsetFeatures;

static int
make(std::uint64_t seed, std::string_view what, const char *name)
{
  constexpr int kSeconds = 60;
  sound::SoundSettings settings{ .seed = seed, .seconds = kSeconds };
  const auto plus = what.find('+');
  settings.impacts = what.starts_with("impacts");
  settings.explosions = what == "explosions";
  settings.music = what == "music" || plus != std::string_view::npos;
  if (plus != std::string_view::npos)
    settings.impacts_db = settings.music_db + std::atof(&what[plus]);
  const sound::SyntheticSound made(settings);
  std::vector<float> frames(static_cast<std::size_t>(kSeconds) * sound::kRate);
  made.render(sound::kRate, 0, sound::usual_speakers(1), frames);
  std::ofstream(name, std::ios::binary)
      .write(reinterpret_cast<const char *>(frames.data()),
             static_cast<std::streamsize>(frames.size() * sizeof(float)));
  for (const sound::SoundEvent &event : made.events())
    if (event.kind == sound::SoundKind::impact || event.kind == sound::SoundKind::explosion)
      std::printf("%.4f\n", std::chrono::duration<double>(event.begin).count());
  return 0;
}

int
main(int argc, char **argv)
{
  if (argc == 5 && std::string_view(argv[1]) == "make")
    return make(std::strtoull(argv[2], nullptr, 10), argv[3], argv[4]);
  if (argc < 2 || argc > 3)
    return 2;
  const std::string_view of = argv[1];
  if (argc == 2) {
    const std::size_t count
        = of == "rumble" ? sound::RumbleFeatures::count : Onset::kCount + Onset::kLaterCount;
    return std::printf("%zu", count) > 0 ? 0 : 1;
  }
  std::ifstream file(argv[2], std::ios::binary);
  const std::vector<char> bytes{ std::istreambuf_iterator<char>(file), {} };
  const std::span frames(reinterpret_cast<const float *>(bytes.data()),
                         bytes.size() / sizeof(float));
  const auto speakers = sound::usual_speakers(1);
  sound::Bands bands(sound::kRate, speakers);
  Onset onset(true);
  sound::RumbleFeatures rumble;
  sound::BandPowers powers;
  int hop = 0;
  for (std::size_t at = 0; at < frames.size(); at += sound::Resampler::kBlock) {
    bands.add(
        frames.subspan(at, std::min<std::size_t>(sound::Resampler::kBlock, frames.size() - at)));
    for (; bands.next(powers); hop++) {
      std::span<const float> row;
      if (of == "rumble") {
        row = rumble.add(powers);
      } else {
        if (onset.add(powers))
          row = onset.features();
      }
      if (row.empty())
        continue;
      const auto number = static_cast<float>(of == "rumble" ? hop : hop - onset.ahead());
      std::fwrite(&number, sizeof number, 1, stdout);
      std::fwrite(row.data(), sizeof(float), row.size(), stdout);
    }
  }
  return 0;
}
