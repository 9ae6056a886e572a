// SPDX-License-Identifier: LGPL-2.1-or-later
#include "browser.h"

#include "files/whole_file.h"

#include <gio/gio.h>

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <unistd.h>

Browser::~Browser()
{
  std::error_code ignored;
  if (!file_.empty())
    std::filesystem::remove(file_, ignored);
}

std::string
Browser::open(const std::string &address)
{
  // Mode 600.
  std::string file = std::string(g_get_user_runtime_dir()) + "/visuotactile-XXXXXX.html";
  const files::File handle(mkostemps(file.data(), 5, O_CLOEXEC));
  if (!handle)
    return files::file_error(file);
  file_ = file;
  if (!files::write_all(handle, "<!DOCTYPE html><meta charset=utf-8><title>visuotactile</title>"
                                "<meta name=referrer content=no-referrer>"
                                "<meta http-equiv=refresh content=\"0; url="
                                    + address + "\">\n"))
    return files::file_error(file);
  g_autofree gchar *uri = g_filename_to_uri(file.c_str(), nullptr, nullptr);
  g_autoptr(GError) error = nullptr;
  if (uri != nullptr && g_app_info_launch_default_for_uri(uri, nullptr, &error))
    return "";
  return error ? error->message : "no browser is known";
}
