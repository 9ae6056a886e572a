// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/cascade_module.h"

#include "modules/load_module.h"

namespace people {

MakeDetector
cascade_detector()
{
  const char *set = g_getenv("VISUOTACTILE_CASCADES");
  const std::string cascade
      = std::string(set != nullptr ? set : CASCADES) + "/haarcascade_frontalface_alt2.xml";
  return [cascade]() -> tl::expected<std::unique_ptr<Detector>, std::string> {
    const auto make = load_module<Detector *(const char *)>(
        "visuotactile-faces", "visuotactile_make_face_detector", MODULES);
    if (!make)
      return tl::unexpected(make.error());
    std::unique_ptr<Detector> detector((*make)(cascade.c_str()));
    if (!detector)
      return tl::unexpected("'" + cascade + "' is not there or cannot be read");
    return detector;
  };
}

} // namespace people
