// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// Ends the chair's own stream where the film's ends, which is at the source pad of `film`.
void end_with(GstElement *chair, GstElement *film);
