// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_tables.h"

namespace quality {

/// Drawn scenes of cinema: travelling cameras, light, titles, textures, people who talk.
Table cinema_table(const Extent &extent, Summary &summary);

/// Checks the floors of the tuned profile on these scenes, and prints violations.
bool cinema_holds(int threads);

} // namespace quality
