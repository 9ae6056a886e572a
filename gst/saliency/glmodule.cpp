// SPDX-License-Identifier: LGPL-2.1-or-later
#include "glmodule.h"

#include "modules/load_module.h"

std::unique_ptr<FrameShrinker>
make_gl_shrinker(GstCaps *caps, int halvings)
{
  static const auto make = load_module<FrameShrinker *(GstCaps *, int)>(
      "visuotactile-gl", "visuotactile_make_gl_shrinker", MODULES);
  if (!make) {
    GST_INFO("frames in OpenGL's memory are read as a whole: %s", make.error().c_str());
    return nullptr;
  }
  return std::unique_ptr<FrameShrinker>((*make)(caps, halvings));
}
