// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gsttactilesynth.h"
#include "gsttactoraudiosink.h"

static gboolean
plugin_init(GstPlugin *plugin)
{
  return GST_ELEMENT_REGISTER(tactilesynth, plugin)
         && GST_ELEMENT_REGISTER(tactoraudiosink, plugin);
}

GST_PLUGIN_DEFINE(GST_VERSION_MAJOR, GST_VERSION_MINOR, synth,
                  "Plays tactile maps as sound on shakers and voice coils", plugin_init,
                  PACKAGE_VERSION, "LGPL", PACKAGE_NAME, PACKAGE_ORIGIN)
