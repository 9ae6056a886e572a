// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib-object.h>

/// Gives visuotactilesink's class its properties. Each but video-sink is one of a child, of the
/// same name: of saliencytactile, of tactorsink, of the video sink, for which it is kept until
/// there is one, or of both sinks. Any thread may use them.
void gst_visuotactile_sink_install_properties(GObjectClass *klass);
