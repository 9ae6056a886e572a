// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "study/folder.h"

#include <cstdint>
#include <string>

namespace study {

/// How simulated participants answer: by a mean of the scale's middle, an effect of one factor,
/// which grows evenly from level to level, and normal deviations of the person and of each answer.
struct Simulation
{
  std::uint64_t seed = 1;
  std::string factor; ///< empty: the first
  double effect = 15; ///< last level − first level
  double spread = 15; ///< standard deviation of people and of answers
};

/// A participant who goes through all steps at once.
tl::expected<void, std::string> simulate_participant(Folder &folder, const Simulation &simulation);

} // namespace study
