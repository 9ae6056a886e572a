// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <opencv2/core/mat.hpp>

namespace saliency {

/// Differences up to this are rounding: float arithmetic on L*a*b* leaves up to 3e-5 between equal
/// colors. A map that spans no more is flat, or N(·) would blow that up to full scale; a sample
/// that rises no further above its neighbors is no maximum, or a plain background would dilute m̄.
inline constexpr float kRounding = 1e-4F;

/// The operator N(·) of Itti, Koch & Niebur (1998), in place, with M = 1: the map is scaled so that
/// its values span [0, 1], then multiplied by (1 - m̄)², m̄ the mean of its other local maxima. One
/// peak is promoted, many are suppressed.
///
/// A local maximum is above all of its 8 neighbors and does not lie on the border, so a plateau is
/// none. One local maximum as high as the global one is left out of m̄: two equal peaks give m̄ = 1
/// and the map vanishes. With no other local maximum m̄ = 0; a global maximum on the border or on a
/// plateau leaves nothing out. A flat map becomes zero. `map`: CV_32FC1, finite.
void normalize_itti(cv::Mat &map);

} // namespace saliency
