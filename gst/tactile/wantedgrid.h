// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The grid of a stream of maps on `pad` whose first map is still to come: what downstream wants,
/// near the paper's 3 × 3.
void wanted_grid(GstPad *pad, guint *rows, guint *columns);
