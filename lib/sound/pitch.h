// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "sound/bands.h"

namespace sound {

/// The frequency at which a sound is felt, for actuators that have a choice: its own mean frequency
/// from 18 to 130 Hz, or 130 to 300 Hz for sounds without low parts, higher for brighter ones. In
/// steps of a third of an octave: smaller ones are hardly felt, and each one ends a cue.
class Pitch
{
public:
  /// Takes the next hop, with the powers of the part that is felt. Returns a frequency in Hz.
  float add(const BandPowers &powers, const Powers &felt);

  void reset()
  {
    *this = Pitch();
  }

private:
  double low_ = 0;
  double slope_ = 0;
  Powers felt_{};
};

} // namespace sound
