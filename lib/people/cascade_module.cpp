// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people/cascade_module.h"

#include <gmodule.h>

#include <filesystem>

namespace people {

namespace {

std::filesystem::path
folder(const char *variable, const char *installed)
{
  const char *set = g_getenv(variable);
  return set != nullptr ? set : installed;
}

} // namespace

MakeDetector
cascade_detector()
{
  const std::string module = folder("VISUOTACTILE_MODULES", MODULES) / "visuotactile-faces.so";
  const std::string cascade
      = folder("VISUOTACTILE_CASCADES", CASCADES) / "haarcascade_frontalface_alt2.xml";
  return [module, cascade]() -> tl::expected<std::unique_ptr<Detector>, std::string> {
    GModule *opened = g_module_open(module.c_str(), G_MODULE_BIND_LOCAL);
    if (opened == nullptr)
      return tl::unexpected(std::string(g_module_error()));
    g_module_make_resident(opened); // detectors have their code in it
    gpointer symbol = nullptr;
    if (!g_module_symbol(opened, "visuotactile_make_face_detector", &symbol))
      return tl::unexpected(std::string(g_module_error()));
    const auto make = reinterpret_cast<Detector *(*)(const char *)>(symbol);
    std::unique_ptr<Detector> detector(make(cascade.c_str()));
    if (!detector)
      return tl::unexpected("'" + cascade + "' is not there or cannot be read");
    return detector;
  };
}

} // namespace people
