// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "table.h"

namespace quality {

/// The effect of cue limits: scores (a) and (d) on the paper's two films, and how much is felt.
Table cue_limit_table(int threads);

/// How often the adaptive viewport changes the strongest cell where the fixed one is right.
Table viewport_table(int threads);

} // namespace quality
