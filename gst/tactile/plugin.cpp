// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gsttactileelements.h"

#include <gst/gst.h>
#include <gst/tactile/tactile.h>

static gboolean
plugin_init(GstPlugin *plugin)
{
  gboolean registered = FALSE;
  gst_tactile_meta_get_info(); // for maps of other processes
  registered |= GST_ELEMENT_REGISTER(tactilecombiner, plugin);
  registered |= GST_ELEMENT_REGISTER(tactileconverter, plugin);
  registered |= GST_ELEMENT_REGISTER(tactileextractor, plugin);
  registered |= GST_ELEMENT_REGISTER(tactileklvdec, plugin);
  registered |= GST_ELEMENT_REGISTER(tactileoverlay, plugin);
  registered |= GST_ELEMENT_REGISTER(tactilesubtitles, plugin);
  registered |= GST_ELEMENT_REGISTER(tactiletestsrc, plugin);
  return registered;
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, tactile,
                  "Tactile maps on video: take out, show, test", plugin_init, PACKAGE_VERSION,
                  "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
