// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthparts.h"

#include "synth/wave_file.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>

/// Each file once, of channels that play one.
bool
SynthParts::read_samples(GstElement *element, const SynthSettings &settings)
{
  const auto &waveforms = settings.carriers.waveforms;
  const std::size_t count = std::min<std::size_t>(
      std::max(waveforms.size(), settings.samples.size()), SynthSettings::kMostChannels);
  carriers.samples.assign(count, nullptr);
  std::map<std::string, std::shared_ptr<const synth::Wave>> files;
  for (std::size_t i = 0; i < count; i++) {
    if (synth::entry_of(waveforms, i) != synth::Waveform::sample)
      continue;
    const std::string path = synth::entry_of(settings.samples, i);
    if (!files.contains(path)) {
      const auto sample = synth::read_wave_file(path);
      if (!sample) {
        GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s.", sample.error().c_str()),
                          ("channel %" G_GSIZE_FORMAT
                           " has waveform=sample, which repeats a file of the property sample",
                           i));
        return false;
      }
      files[path] = *sample;
    }
    carriers.samples[i] = files[path];
  }
  return true;
}

bool
SynthParts::open(GstElement *element, const SynthSettings &settings)
{
  if (!settings.faults.empty()) {
    const auto &[property, why] = *settings.faults.begin();
    GST_ELEMENT_ERROR(element, LIBRARY, SETTINGS,
                      ("%s cannot be read: %s.", property.c_str(), why.c_str()), (nullptr));
    return false;
  }
  carriers = settings.carriers;
  if (!read_samples(element, settings))
    return false;
  tl::expected<SynthMotors, std::string> read = SynthMotors::read(settings);
  if (!read) {
    GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s.", read.error().c_str()), (nullptr));
    return false;
  }
  motors = std::move(*read);
  carriers.tunings = motors.tunings(SynthSettings::kMostChannels);
  if (settings.trace_location.empty())
    return true;
  tl::expected<tactor::CommandTrace, tactor::DriverError> made
      = tactor::CommandTrace::create(settings.trace_location);
  if (!made) {
    GST_ELEMENT_ERROR(element, RESOURCE, OPEN_WRITE, ("%s.", made.error().text.c_str()), (nullptr));
    return false;
  }
  trace.emplace(std::move(*made));
  return true;
}

void
SynthParts::close(GstElement *element)
{
  if (!trace)
    return;
  trace->flush();
  if (trace->failed())
    GST_ELEMENT_WARNING(element, RESOURCE, WRITE, ("The command trace is incomplete."),
                        ("writing to it failed: is the disk full?"));
  trace.reset();
}
