// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synth/carriers.h"

#include "text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

namespace synth {

using visuotactile::trimmed;

namespace {

using Error = tl::unexpected<std::string>;

/// More than there are channels.
constexpr std::size_t kMostEntries = 4096;

constexpr std::array<std::string_view, 5> kNames
    = { "sine", "triangle", "square", "noise", "sample" };

/// Noise of neighbors is this many rounds apart: the golden section spreads any number of them.
constexpr double kApart = 0.6180339887;

std::string
text_of(double value)
{
  char buffer[32];
  return { buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr };
}

template <typename Entry, typename Read>
tl::expected<std::vector<Entry>, std::string>
read_list(std::string_view text, const std::string &expected, Read read)
{
  std::vector<Entry> entries;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view word = trimmed(text.substr(0, comma));
    const std::optional<Entry> entry = read(word);
    if (!entry || entries.size() == kMostEntries)
      return Error("entry " + std::to_string(entries.size() + 1) + " is '" + std::string(word)
                   + "'; expected " + expected);
    entries.push_back(*entry);
    if (comma == std::string_view::npos)
      return entries;
    text = text.substr(comma + 1);
  }
}

template <typename Entries, typename Write>
std::string
write_list(const Entries &entries, Write write)
{
  std::string text;
  for (const auto &entry : entries)
    text.append(write(entry)).append(",");
  if (!text.empty())
    text.pop_back();
  return text;
}

} // namespace

std::vector<Voice>
Carriers::voices(int channels) const
{
  using Kind = std::tuple<Waveform, double, const Wave *, std::vector<EqualizerBand>>;
  std::map<Kind, Equalized> waves;
  std::vector<Voice> voices;
  for (std::size_t i = 0; i < static_cast<std::size_t>(channels); i++) {
    const Waveform waveform = entry_of(waveforms, i);
    const double frequency = entry_of(frequencies, i);
    const auto sample = waveform == Waveform::sample ? entry_of(samples, i) : nullptr;
    const Tuning tuning = i < tunings.size() ? tunings[i] : Tuning();
    Equalized &carrier = waves[{ waveform, frequency, sample.get(), tuning.equalizer }];
    if (!carrier.wave)
      carrier = equalized(sample ? sample : make_wave(waveform, frequency), tuning.equalizer);
    voices.push_back({ .wave = carrier.wave,
                       .phase = waveform == Waveform::noise ? kApart * static_cast<double>(i) : 0,
                       .gain = static_cast<float>(entry_of(gains, i) * tuning.gain * carrier.peak),
                       .frequency = waveform == Waveform::sine ? frequency : 0,
                       .equalizer = tuning.equalizer });
  }
  return voices;
}

tl::expected<std::vector<double>, std::string>
read_numbers(std::string_view text, double least, double most)
{
  return read_list<double>(
      text, text_of(least) + " to " + text_of(most) + " for each channel, with commas, as in 40,60",
      [&](std::string_view word) -> std::optional<double> {
        const auto value = visuotactile::read_number<double>(word);
        return value && *value >= least && *value <= most ? value : std::nullopt;
      });
}

std::string
write_numbers(std::span<const double> numbers)
{
  return write_list(numbers, text_of);
}

tl::expected<std::vector<Waveform>, std::string>
read_waveforms(std::string_view text)
{
  return read_list<Waveform>(
      text, write_list(kNames, [](std::string_view name) { return name; }) + " for each channel",
      [](std::string_view word) -> std::optional<Waveform> {
        const auto *const found = std::ranges::find(kNames, word);
        if (found == kNames.end())
          return std::nullopt;
        return static_cast<Waveform>(found - kNames.begin());
      });
}

std::string
write_waveforms(std::span<const Waveform> waveforms)
{
  return write_list(waveforms,
                    [](Waveform waveform) { return kNames[static_cast<std::size_t>(waveform)]; });
}

tl::expected<std::vector<std::string>, std::string>
read_names(std::string_view text)
{
  return read_list<std::string>(
      text, "fewer files", [](std::string_view word) { return std::optional<std::string>(word); });
}

std::string
write_names(std::span<const std::string> names)
{
  return write_list(names, [](const std::string &name) -> const std::string & { return name; });
}

} // namespace synth
