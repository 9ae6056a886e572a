// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gstsaliencytactile.h"

#include <gst/tactile/tactile.h>

static gboolean
plugin_init(GstPlugin *plugin)
{
  gst_tactile_meta_get_info(); // for maps of other processes
  return GST_ELEMENT_REGISTER(saliencytactile, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, saliency,
                  "Finds what draws the eye in a film and turns it into touch", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
