// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthsettings.h"

#include "tactor/mapping.h"

#include <utility>

namespace {

using P = properties::Property<SynthSettings>;
using properties::kControllable;
using properties::kPlaying;
using properties::kReady;

const std::string &
text_of(const std::string &error)
{
  return error;
}

const std::string &
text_of(const tactor::DriverError &error)
{
  return error.text;
}

/// Takes what was read. Text that cannot be read leaves the field unchanged.
template <typename Field, typename Error>
void
take(SynthSettings &settings, const char *property, Field &field, tl::expected<Field, Error> read)
{
  settings.faults.erase(property);
  if (read)
    field = std::move(*read);
  else
    settings.faults[property] = text_of(read.error());
}

std::optional<std::string>
write_frequency(const SynthSettings &settings)
{
  return synth::write_numbers(settings.carriers.frequencies);
}

void
read_frequency(SynthSettings &settings, const gchar *text)
{
  take(settings, "frequency", settings.carriers.frequencies,
       synth::read_numbers(text ? text : "", 1, synth::kHighest));
}

std::optional<std::string>
write_waveform(const SynthSettings &settings)
{
  return synth::write_waveforms(settings.carriers.waveforms);
}

void
read_waveform(SynthSettings &settings, const gchar *text)
{
  take(settings, "waveform", settings.carriers.waveforms, synth::read_waveforms(text ? text : ""));
}

std::optional<std::string>
write_sample(const SynthSettings &settings)
{
  const std::string text = synth::write_names(settings.samples);
  return text.empty() ? std::nullopt : std::optional(text);
}

void
read_sample(SynthSettings &settings, const gchar *text)
{
  take(settings, "sample", settings.samples, synth::read_names(text ? text : ""));
}

std::optional<std::string>
write_gain(const SynthSettings &settings)
{
  return synth::write_numbers(settings.carriers.gains);
}

void
read_gain(SynthSettings &settings, const gchar *text)
{
  take(settings, "gain", settings.carriers.gains, synth::read_numbers(text ? text : "", 0, 1));
}

std::optional<std::string>
write_mapping(const SynthSettings &settings)
{
  return tactor::write_mapping(settings.mapping);
}

void
read_mapping(SynthSettings &settings, const gchar *text)
{
  take(settings, "mapping", settings.mapping,
       tactor::read_mapping(text ? text : "", SynthSettings::kMostChannels));
}

constexpr P kProperties[] = {
  P::parsed<write_frequency, read_frequency>("frequency",
                                             "Carrier of each channel in Hz, 1 to 1000, as in "
                                             "40,60; all further channels have the last one",
                                             kReady),
  P::parsed<write_waveform, read_waveform>(
      "waveform",
      "Waveform of each channel, in a list as that of frequency: sine, triangle, square, noise (an "
      "octave around the frequency) or sample",
      kReady),
  P::parsed<write_sample, read_sample>(
      "sample",
      "WAVE file that waveform=sample repeats, for each channel, in a list as that of frequency: "
      "mono, 16 bit or float, up to 10 s",
      kReady),
  P::parsed<write_gain, read_gain>(
      "gain",
      "Share of full scale at level 1, 0 to 1, for each channel, in a list as that of frequency",
      kReady),
  P::parsed<write_mapping, read_mapping>(
      "mapping",
      "Channel of each cell, row by row, -1 for none, as in 2,1,0 (empty: from the number and "
      "positions of the channels)",
      kReady),
  P::number<guint64>("rise-time",
                     "Time in ns in which a shaker reaches 90 % of its vibration; it is driven "
                     "before its frame by this time",
                     kReady, PROPERTY_FIELD(rise_time), P::Range{ 0, GST_SECOND }),
  P::text("calibration",
          "Key file of tactor-calibrate: each channel's rise times, latency, start volts, "
          "strength, gain and equalizer (unset: rise-time for all)",
          kReady, PROPERTY_FIELD(calibration)),
  P::number<gdouble>("voltage-max", "Volts of the calibration at full scale", kReady,
                     PROPERTY_FIELD(volts_max), P::Range{ 0.1, 24 }),
  P::text("trace-location",
          "CSV file to write, one line per change of a channel, as that of tactorsink: "
          "issued_ns,due_ns,effect_ns,tactor,volts",
          kReady, PROPERTY_FIELD(trace_location)),
  P::number<gdouble>("rate", "Rate in Hz at which channels may change (0 = with every map)",
                     kPlaying, PROPERTY_FIELD(rate), P::Range{ 0, 1000 }),
  P::number<gdouble>("intensity",
                     "Factor on all levels, from the next map on; 0: all channels at zero",
                     kControllable, PROPERTY_FIELD(intensity), P::Range{ 0, 1 }),
  P::flag("mute", "All channels at zero, from the next buffer of 20 ms on", kControllable,
          PROPERTY_FIELD(mute)),
  P::number<guint64>("max-on-time",
                     "Longest time in ns for which a channel is on without a break (0 = unlimited)",
                     kPlaying, PROPERTY_FIELD(limits.max_on_time)),
  P::number<gdouble>("max-duty",
                     "Largest share of any 60 s for which a channel is on (0 = unlimited)",
                     kPlaying, PROPERTY_FIELD(limits.max_duty), P::Range{ 0, 1 }),
  P::number<guint>(
      "max-active", "Largest number of channels on at once; the strongest play (0 = unlimited)",
      kPlaying, PROPERTY_FIELD(limits.max_active), P::Range{ 0, SynthSettings::kMostChannels }),
  P::number<guint64>("ramp-in",
                     "Time in ns in which vibration rises to full scale after start, seek and mute",
                     kPlaying, PROPERTY_FIELD(ramp_in), P::Range{ 0, 10.0 * GST_SECOND }),
};

} // namespace

std::span<const P>
SynthSettings::table()
{
  return kProperties;
}
