// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gstsoundelements.h"

#include <gst/gst.h>

static gboolean
plugin_init(GstPlugin *plugin)
{
  gboolean registered = FALSE;
  registered |= GST_ELEMENT_REGISTER(soundtactile, plugin);
  registered |= GST_ELEMENT_REGISTER(tactilesoundtestsrc, plugin);
  return registered;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, tactilesound, "Films' sound that is felt",
                  plugin_init, PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
