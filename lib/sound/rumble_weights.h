// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Made by tests/sound/train.py; do not edit.
#pragma once

#include <array>

/// The mean, scale and weight of each of RumbleFeatures after the first.
namespace sound {

inline constexpr std::array<float, 8> kRumbleMean{ -7.828F, 8.195F, -1.638F, 6.927F,
                                                   5.336F,  3.102F, 6.172F,  9.F };
inline constexpr std::array<float, 8> kRumbleScale{ 0.1359F, 0.08737F, 0.1576F, 0.3246F,
                                                    0.565F,  1.207F,   0.2259F, 0.1132F };
inline constexpr std::array<float, 8> kRumbleWeights{ -2.117F, 1.838F, 0.5731F,  -0.8021F,
                                                      -1.512F, 0.148F, -0.1979F, 0.8596F };
inline constexpr float kRumbleOffset = -0.5653F;

} // namespace sound
