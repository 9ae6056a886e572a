// SPDX-License-Identifier: LGPL-2.1-or-later
#include "synthparts.h"

#include "synth/wave_file.h"

#include <algorithm>
#include <utility>

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
  if (std::ranges::find(carriers.waveforms, synth::Waveform::sample) != carriers.waveforms.end()) {
    const auto sample = synth::read_wave_file(settings.sample);
    if (!sample) {
      GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s.", sample.error().c_str()),
                        ("waveform=sample repeats the file of the property sample"));
      return false;
    }
    carriers.sample = *sample;
  }
  tl::expected<SynthMotors, std::string> read = SynthMotors::read(settings);
  if (!read) {
    GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s.", read.error().c_str()), (nullptr));
    return false;
  }
  motors = std::move(*read);
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
