// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/synthesizer.h"
#include "synth/wave.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace synth {

/// What channels play. Channel i has entry i of each list; those beyond its end have the last one.
struct Carriers
{
  std::vector<double> frequencies = { 60 }; ///< Hz, 1 to kHighest
  std::vector<Waveform> waveforms = { Waveform::sine };
  std::vector<double> gains = { 1 };    ///< [0, 1]
  std::shared_ptr<const Wave> sample{}; ///< for Waveform::sample

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

} // namespace synth
