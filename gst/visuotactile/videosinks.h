// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

/// The video sink of the highest rank that reaches READY, left in NULL; never one of those that
/// would choose in turn (visuotactilesink, autovideosink), nor kCrashingVideoSink. Floating. NULL
/// if there is none; `errors` then has the reasons, one line each.
GstElement *choose_video_sink(const gchar *name, GString *errors);

/// Sets a property of the element or, where that has none of this name, of all elements in it that
/// have.
void set_property_within(GstElement *element, const gchar *name, const GValue *value);

/// Gets it from the element, or the first in it that has such a property. False if there is none.
bool get_property_within(GstElement *element, const gchar *name, GValue *value);

/// The element or the first in it that implements the interface; transfer full, may be NULL.
GstElement *find_interface_within(GstElement *element, GType iface);
