// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "table.h"

#include <filesystem>

namespace quality {

/// The effect of cue limits: scores (a) and (d) on the paper's two films, and how much is felt.
Table cue_limit_table(int threads);

/// How often the adaptive viewport changes the strongest cell where the fixed one is right.
Table viewport_table(int threads);

/// How much is felt of the films in a directory with a density control. Throws std::runtime_error
/// as list_films() and Decoder do.
Table density_table(const std::filesystem::path &directory);

} // namespace quality
