// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Made by tests/sound/train.py; do not edit.
#pragma once

#include <array>

/// One hidden layer of RumbleFeatures after the first.
namespace sound {

inline constexpr std::array<float, 15> kRumbleMean{ -2.138F, -3.889F, -1.292F, 3.05F,  8.079F,
                                                    12.4F,   18.62F,  6.429F,  5.451F, 3.345F,
                                                    5.292F,  3.205F,  3.093F,  5.677F, 6.248F };
inline constexpr std::array<float, 15> kRumbleScale{ 0.1716F,  0.1372F,  0.0972F,  0.08555F,
                                                     0.08435F, 0.08495F, 0.09261F, 0.3325F,
                                                     0.5723F,  1.14F,    0.623F,   1.138F,
                                                     1.152F,   0.2247F,  0.1081F };
inline constexpr std::array<float, 120> kRumbleHidden{
  0.151F,    0.3334F,   -0.2641F, 0.3319F,   0.6098F,  0.6361F,   -0.08866F, 0.1703F,    0.2873F,
  0.5654F,   -0.4352F,  0.3523F,  0.2928F,   0.0747F,  -0.4851F,  0.2857F,   0.2078F,    -0.3954F,
  0.2523F,   -0.01255F, -0.4588F, -0.2912F,  0.1744F,  -0.05507F, -0.5422F,  -0.6626F,   0.2332F,
  0.1873F,   -1.005F,   -0.1678F, -1.689F,   0.5977F,  -0.02981F, 0.7103F,   -0.1187F,   0.1896F,
  0.1461F,   -1.026F,   -0.1012F, -0.03913F, 0.7153F,  -0.1886F,  0.3594F,   0.4214F,    -1.475F,
  2.013F,    0.2051F,   -0.2938F, 0.3746F,   0.04543F, 0.7931F,   -0.5148F,  0.8011F,    -0.4274F,
  0.2669F,   -0.3098F,  0.4199F,  0.4327F,   -0.1598F, -1.28F,    0.3326F,   -0.1204F,   -0.1734F,
  -0.05866F, -0.723F,   0.1434F,  0.3869F,   0.08996F, -1.103F,   0.1029F,   0.3729F,    -0.01915F,
  0.2051F,   0.0832F,   0.2527F,  -0.445F,   0.3204F,  -0.6174F,  0.6596F,   -0.006303F, -0.1166F,
  0.3081F,   -0.5617F,  -0.3822F, -0.0153F,  0.1632F,  -0.6408F,  0.15F,     -0.06264F,  -0.4995F,
  -0.2221F,  0.4673F,   0.258F,   -0.1452F,  0.1891F,  0.04432F,  -0.2377F,  0.2893F,    0.3847F,
  -0.191F,   -0.3245F,  0.1393F,  -0.08227F, 0.5401F,  -1.388F,   0.2356F,   -0.0894F,   -0.2492F,
  -0.1398F,  -0.05049F, 1.094F,   -0.2391F,  0.2081F,  -0.3037F,  0.2619F,   -0.6604F,   0.4973F,
  0.000448F, -0.03121F, -0.3896F
};
inline constexpr std::array<float, 8> kRumbleHiddenOffset{ 0.8302F,  -0.1784F, 0.9015F, 0.6574F,
                                                           0.07835F, 1.548F,   -0.9F,   0.7266F };
inline constexpr std::array<float, 8> kRumbleOut{ 1.011F, 0.9195F, -1.232F, -1.334F,
                                                  1.064F, 1.3F,    1.507F,  1.066F };
inline constexpr float kRumbleOffset = -2.9649F;

} // namespace sound
