// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

namespace saliency {

/// Differences up to this are rounding errors: float arithmetic on L*a*b* leaves up to 3e-5 between
/// equal colors. A map with a smaller range counts as flat, since N(·) would scale the noise to
/// full range. A sample that rises less above its neighbors is no maximum, or plain background
/// would dilute m̄.
inline constexpr float kRounding = 1e-4F;

/// The operator N(·) of Itti, Koch & Niebur (1998) with M = 1, in place. The map is scaled to span
/// [0, 1] and multiplied by (1 - m̄)², with m̄ the mean of its other local maxima. One peak is
/// promoted, many are suppressed.
///
/// A local maximum is above all 8 neighbors and not on the border, so a plateau has none. One local
/// maximum as high as the global one is left out of m̄; two equal peaks give m̄ = 1 and a zero map.
/// Without other local maxima m̄ = 0. A global maximum on the border or on a plateau leaves nothing
/// out. A flat map becomes zero. `map`: CV_32FC1, finite.
void normalize_itti(cv::Mat &map);

} // namespace saliency
