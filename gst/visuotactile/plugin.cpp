// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gstvisuotactiledecoder.h"
#include "gstvisuotactilesink.h"

#include <gst/tactile/tactile.h>

static gboolean
plugin_init(GstPlugin *plugin)
{
  // The decoder's rank depends on them.
  gst_plugin_add_dependency_simple(
      plugin, "XDG_CONFIG_HOME/visuotactile:HOME/.config/visuotactile:VISUOTACTILE_ENABLED",
      nullptr, "chair.conf", GST_PLUGIN_DEPENDENCY_FLAG_NONE);
  gst_tactile_meta_get_info(); // for maps of other processes
  bool registered = GST_ELEMENT_REGISTER(visuotactilesink, plugin);
  registered |= GST_ELEMENT_REGISTER(visuotactiledecoder, plugin);
  return registered;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, visuotactile,
                  "Shows a film and plays what is felt of it, in any player", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
