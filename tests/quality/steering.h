// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "table.h"

namespace quality {

/// What limits to cues cost and give: (a) and (d) on the paper's two films, and how much is felt.
Table cue_limit_table(int threads);

/// How often the adaptive viewport moves what is felt to another cell where the fixed one is right.
Table viewport_table(int threads);

} // namespace quality
