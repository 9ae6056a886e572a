// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib-object.h>

/// Installs visuotactilesink's properties. All but video-sink are forwarded to the property of that
/// name of saliencytactile, tactorsink, the video sink (kept until there is one), or both sinks.
/// They may be used on any thread.
void gst_visuotactile_sink_install_properties(GObjectClass *klass);
