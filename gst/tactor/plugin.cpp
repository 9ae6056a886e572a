// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gsttactordeviceprovider.h"
#include "gsttactorsink.h"

#include <gst/tactile/tactile.h>

static gboolean
plugin_init(GstPlugin *plugin)
{
  gst_tactile_meta_get_info(); // for maps of other processes
  return GST_ELEMENT_REGISTER(tactorsink, plugin)
         && GST_DEVICE_PROVIDER_REGISTER(tactordeviceprovider, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, tactor,
                  "Drives vibration motors (tactors) early, on the pipeline clock", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
