// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "synth/wave.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include <tl/expected.hpp>

namespace synth {

/// Reads a loop: RIFF WAVE, one channel, 16 bit integers or 32 bit floats, 1000 to 192000 Hz, two
/// samples to 10 s. Its repetitions a second are its Wave::frequency. The error is one line: what
/// was expected and what came.
tl::expected<std::shared_ptr<const Wave>, std::string>
parse_wave_file(std::span<const std::byte> data);

/// As parse_wave_file(), of a file. The error begins with its name.
tl::expected<std::shared_ptr<const Wave>, std::string> read_wave_file(const std::string &path);

} // namespace synth
