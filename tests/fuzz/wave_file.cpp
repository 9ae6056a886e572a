// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Fuzzes WAVE files (tactilesynth's sample): a loop that parses has two samples and more, none
// beyond full scale, and an equalizer leaves a carrier of full scale. Other input is refused with a
// reason.
#include "synth/wave_file.h"
#include "synth/equalizer.h"

#include "fuzz.h"

#include <algorithm>
#include <cmath>

namespace {

bool
is_loop(const synth::Wave &wave)
{
  return wave.samples.size() >= 3 && wave.samples.front() == wave.samples.back()
         && wave.frequency > 0 && std::isfinite(wave.frequency)
         && std::ranges::all_of(wave.samples,
                                [](float sample) { return sample >= -1 && sample <= 1; });
}

} // namespace

extern "C" int
LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size)
{
  const auto wave = synth::parse_wave_file(std::as_bytes(std::span(data, size)));
  if (!wave) {
    expect(!wave.error().empty());
    return 0;
  }
  expect(is_loop(**wave));
  const synth::EqualizerBand bands[] = { { 1, 24, 20 }, { 1000, -24, 0.1 } };
  const synth::Equalized carrier = synth::equalized(*wave, bands);
  expect(is_loop(*carrier.wave) && carrier.peak >= 0 && carrier.peak < 1000);
  return 0;
}
