// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/folder.h"

#include <cstdint>
#include <string>

namespace study {

/// The answers of simulated participants: the middle of the scale, an effect of one factor, which
/// grows evenly from level to level, and normal deviations of the person and of each answer.
struct Simulation
{
  std::uint64_t seed = 1;
  std::string factor; ///< empty: the first
  double effect = 15; ///< last level − first level
  double spread = 15; ///< standard deviation of people and of answers
};

/// Adds a participant and answers all steps at once.
tl::expected<void, std::string> simulate_participant(Folder &folder, const Simulation &simulation);

} // namespace study
