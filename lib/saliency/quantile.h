// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace saliency {

/// The value at place q (n - 1), rounded down, 0 ≤ q ≤ 1, of n ≥ 1 finite values ≥ 0 in ascending
/// order. The values are used up.
float quantile(std::vector<float> &values, double q);

} // namespace saliency
