// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <span>

namespace saliency {

/// The q-quantile, 0 ≤ q ≤ 1, of n ≥ 1 finite values ≥ 0: the value at index ⌊q (n - 1)⌋ in
/// ascending order; denormals count as 0. Reorders `values`.
float quantile(std::span<float> values, double q);

} // namespace saliency
