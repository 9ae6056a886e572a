// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <vector>

namespace saliency {

/// The q-quantile, 0 ≤ q ≤ 1, of n ≥ 1 finite values ≥ 0: the value at index ⌊q (n - 1)⌋ in
/// ascending order. Modifies `values`.
float quantile(std::vector<float> &values, double q);

} // namespace saliency
