// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/websocket/server_address.h"

#include "text.h"

#include <algorithm>
#include <string_view>

namespace tactor {

namespace {

bool
is_port(std::string_view text)
{
  const int port = visuotactile::read_number<int>(text).value_or(0);
  return port >= 1 && port <= 65535;
}

/// A name, an IPv4 address, or an IPv6 address in brackets.
bool
is_host(std::string_view text)
{
  const bool has_brackets = text.size() > 2 && text.front() == '[' && text.back() == ']';
  const std::string_view host = has_brackets ? text.substr(1, text.size() - 2) : text;
  return !host.empty() && std::ranges::all_of(host, [&](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')
           || c == (has_brackets ? ':' : '-') || c == '.';
  });
}

} // namespace

tl::expected<ServedName, DriverError>
read_served_name(const std::string &device, int default_port)
{
  const std::size_t at = device.rfind('@');
  std::string_view host = "127.0.0.1";
  std::string_view port;
  if (at != std::string::npos) {
    host = std::string_view(device).substr(at + 1);
    const std::size_t colon = host.rfind(':');
    if (colon != std::string_view::npos && host.back() != ']') {
      port = host.substr(colon + 1);
      host = host.substr(0, colon);
      if (!is_port(port))
        host = {};
    }
  }
  if (!is_host(host))
    return tl::unexpected(DriverError{
        DriverError::Kind::settings,
        "device is '" + device + "'; expected a name, or NAME@HOST or NAME@HOST:PORT, as in "
            + "vest-back@192.168.1.5:" + std::to_string(default_port) });
  return ServedName{ .name = device.substr(0, at),
                     .address
                     = std::string(host) + ':'
                       + (port.empty() ? std::to_string(default_port) : std::string(port)) };
}

} // namespace tactor
