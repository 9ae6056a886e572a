// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film_tables.h"
#include "summary.h"
#include "table.h"

namespace quality {

/// Real films: a row for each method, over all films with labels, and every film.
Section clip_section(const Extent &extent, Summary &summary);

} // namespace quality
