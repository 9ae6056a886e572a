// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/web.h"

#include "modules/load_module.h"

namespace library {

bool
is_address(const std::string &where)
{
  return where.find("://") != std::string::npos && !where.starts_with("file://");
}

tl::expected<std::string, std::string>
fetch(const std::string &address, std::size_t most, GCancellable *stop)
{
  return fetch({ .address = address,
                 .most = most,
                 .stop = stop,
                 .advice = "is it a folder with tracks and their index (tactile-track index)?" });
}

tl::expected<std::string, std::string>
fetch(const Query &query)
{
  const std::string &address = query.address;
  g_autoptr(GUri) uri = g_uri_parse(address.c_str(), G_URI_FLAGS_HAS_PASSWORD, nullptr);
  const std::string scheme = uri != nullptr ? g_uri_get_scheme(uri) : "";
  if ((scheme != "http" && scheme != "https") || g_uri_get_host(uri) == nullptr
      || *g_uri_get_host(uri) == '\0' || g_uri_get_userinfo(uri) != nullptr
      || g_uri_get_query(uri) != nullptr || g_uri_get_fragment(uri) != nullptr)
    return tl::unexpected("'" + address
                          + "': expected http://HOST/FOLDER or https://HOST/FOLDER without a user, "
                            "'?' or '#'");
  const auto function = load_module<Fetch>("visuotactile-web", "visuotactile_fetch", MODULES);
  if (!function)
    return tl::unexpected("the module for web servers cannot be loaded: " + function.error()
                          + "; install visuotactile-tools, or name a folder");
  std::string body;
  std::string error;
  if (!(*function)(query, body, error))
    return tl::unexpected("'" + address + "': " + error);
  return body;
}

} // namespace library
