// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace judged {

/// What a speech synthesizer said.
struct Speech
{
  int rate = 0;
  std::vector<float> samples; ///< at −20 dB of full scale
};

/// A WAV file with 16-bit samples, mono. Empty if it is none.
Speech read_speech(const char *name);

} // namespace judged
