// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/equalizer.h"
#include "synth/synthesizer.h"
#include "synth/wave.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace synth {

/// What a channel has of a list with an entry at least: those beyond its end have the last one.
template <typename Entry>
Entry
entry_of(const std::vector<Entry> &entries, std::size_t channel)
{
  return entries[std::min(channel, entries.size() - 1)];
}

/// What is measured of a channel, so that it is right at any carrier.
struct Tuning
{
  double gain = 1; ///< factor, also beyond 1
  std::vector<EqualizerBand> equalizer{};
};

/// What channels play, by entry_of() of each list.
struct Carriers
{
  std::vector<double> frequencies = { 60 }; ///< Hz, 1 to kHighest
  std::vector<Waveform> waveforms = { Waveform::sine };
  std::vector<double> gains = { 1 };                  ///< [0, 1]
  std::vector<std::shared_ptr<const Wave>> samples{}; ///< of channels with Waveform::sample
  std::vector<Tuning> tunings{};                      ///< of the first channels; others have none

  /// Of equal channels, the noise of each is at another place of its round.
  std::vector<Voice> voices(int channels) const;
};

/// Reads numbers within [least, most] with commas between them, "40,60", one at least. The error
/// names the entry and what was expected.
tl::expected<std::vector<double>, std::string> read_numbers(std::string_view text, double least,
                                                            double most);
std::string write_numbers(std::span<const double> numbers);

/// As read_numbers(), of names of waveforms: "sine,noise".
tl::expected<std::vector<Waveform>, std::string> read_waveforms(std::string_view text);
std::string write_waveforms(std::span<const Waveform> waveforms);

/// As read_numbers(), of names of files, which may be empty: "purr.wav,,click.wav".
tl::expected<std::vector<std::string>, std::string> read_names(std::string_view text);
std::string write_names(std::span<const std::string> names);

} // namespace synth
