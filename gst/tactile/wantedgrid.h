// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Grid before the first map: what downstream of `pad` accepts, nearest to the paper's 3 × 3.
void wanted_grid(GstPad *pad, guint *rows, guint *columns);
