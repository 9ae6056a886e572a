// SPDX-License-Identifier: LGPL-2.1-or-later
#include "listen/film_sound.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace listen {

// The resampler converts to sound::kRate. With twice the input rate, its output is the sound at
// kRate.
static_assert(sound::kRate == 2 * kRate);

Downsampler::Downsampler(int rate) : resampler_(2 * rate, 1)
{
}

void
Downsampler::add(std::span<const float> mono, std::vector<float> &out)
{
  while (!mono.empty()) {
    const std::size_t count
        = std::min(mono.size(), static_cast<std::size_t>(sound::Resampler::kBlock));
    resampler_.add(mono.first(count));
    mono = mono.subspan(count);
    for (float sample = 0; resampler_.take({ &sample, 1 });)
      out.push_back(sample);
  }
}

namespace {

/// The strongest hashes of each second, with their ranks.
std::vector<RankedHash>
ranked(std::vector<Hash> hashes)
{
  const auto second = [](const Hash &hash) {
    return second_of(hash.frame);
  };
  std::ranges::sort(hashes, [&](const Hash &a, const Hash &b) {
    return std::pair(second(a), -a.strength) < std::pair(second(b), -b.strength);
  });
  std::vector<RankedHash> kept;
  std::int64_t at = -1;
  int count = 0;
  unsigned rank = 0;
  for (const Hash &hash : hashes) {
    if (std::exchange(at, second(hash)) != second(hash)) {
      count = 0;
      rank = 0;
    }
    if (rank < kRanks && count++ == kOfRank[rank])
      rank++;
    if (rank < kRanks)
      kept.push_back({ .frame = hash.frame, .value = hash.value, .rank = rank });
  }
  std::ranges::sort(kept, {},
                    [](const RankedHash &hash) { return std::pair(hash.frame, hash.value); });
  return kept;
}

} // namespace

FilmSoundMaker::FilmSoundMaker(int rate) : downsampler_(rate), peaks_finder_(kFilmPeaks)
{
}

void
FilmSoundMaker::add(std::span<const float> mono)
{
  samples_.clear();
  downsampler_.add(mono, samples_);
  peaks_finder_.add(samples_);
  onsets_.add(samples_);
  const std::vector<Peak> peaks = peaks_finder_.take();
  peaks_.insert(peaks_.end(), peaks.begin(), peaks.end());
  for (const Onset &onset : onsets_.take())
    sound_.reference.push_back(signs(onset));
}

FilmSound
FilmSoundMaker::finish()
{
  add(std::vector<float>(512)); // flushes resampler and spectra
  sound_.hashes = ranked(film_hashes(peaks_));
  return std::move(sound_);
}

} // namespace listen
