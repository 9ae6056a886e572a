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

/// The entry of a channel in a list with one entry at least; channels beyond its end have the last.
template <typename Entry>
Entry
entry_of(const std::vector<Entry> &entries, std::size_t channel)
{
  return entries[std::min(channel, entries.size() - 1)];
}

/// The measured properties of a channel, which hold at any carrier.
struct Tuning
{
  double gain = 1; ///< factor, also beyond 1
  std::vector<EqualizerBand> equalizer{};
};

/// The carriers of channels, by entry_of() of each list.
struct Carriers
{
  std::vector<double> frequencies = { 60 }; ///< Hz, 1 to kHighest
  std::vector<Waveform> waveforms = { Waveform::sine };
  std::vector<double> gains = { 1 };                  ///< [0, 1]
  std::vector<std::shared_ptr<const Wave>> samples{}; ///< of channels with Waveform::sample
  std::vector<Tuning> tunings{};                      ///< of the first channels; others have none

  /// Equal channels have noise from different places of its round.
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
