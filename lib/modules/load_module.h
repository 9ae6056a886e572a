// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tl/expected.hpp>

#include <gmodule.h>

#include <string>

/// Loads a module of this folder, such as "visuotactile-faces", for good, and finds a function of
/// it. $VISUOTACTILE_MODULES is where modules are searched, else where they are installed
/// (`installed`). The error says why it cannot be loaded.
template <typename Function>
tl::expected<Function *, std::string>
load_module(const char *name, const char *function, const char *installed)
{
  const char *set = g_getenv("VISUOTACTILE_MODULES");
  const std::string file = std::string(set != nullptr ? set : installed) + "/" + name + ".so";
  GModule *opened = g_module_open(file.c_str(), G_MODULE_BIND_LOCAL);
  gpointer symbol = nullptr;
  if (opened == nullptr || !g_module_symbol(opened, function, &symbol))
    return tl::unexpected(std::string(g_module_error()));
  g_module_make_resident(opened); // what the function makes has its code in it
  return reinterpret_cast<Function *>(symbol);
}
