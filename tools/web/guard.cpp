// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guard.h"

#include "soup.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <sys/random.h>
#include <unistd.h>

namespace {

/// Takes the same time wherever they differ.
bool
equal(const std::string &a, const std::string &b)
{
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); i++)
    difference |= static_cast<unsigned>(a[i]) ^ static_cast<unsigned>(b[i]);
  return difference == 0;
}

guint16
port_of(GSocketAddress *address)
{
  return g_inet_socket_address_get_port(G_INET_SOCKET_ADDRESS(address));
}

/// Whether this user has the other end of a connection on this computer, by the kernel's tables. An
/// end that is closed is root's.
bool
is_of_this_user(SoupServerMessage *message)
{
  const unsigned remote = port_of(soup_server_message_get_remote_address(message));
  const unsigned local = port_of(soup_server_message_get_local_address(message));
  for (const char *table : { "/proc/net/tcp", "/proc/net/tcp6" }) {
    std::ifstream file(table);
    for (std::string line; std::getline(file, line);) {
      unsigned from = 0;
      unsigned to = 0;
      unsigned user = 0;
      if (std::sscanf(line.c_str(),
                      "%*s %*[0-9A-F]:%x %*[0-9A-F]:%x %*x %*[0-9A-F:] %*[0-9A-F:] %*x %u", &from,
                      &to, &user)
              == 3
          && from == remote && to == local)
        return user == geteuid();
    }
  }
  return false;
}

} // namespace

std::string
random_token()
{
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system has no random numbers");
  std::string text;
  for (const unsigned byte : bytes) {
    std::array<char, 3> hex{};
    std::snprintf(hex.data(), hex.size(), "%02x", byte);
    text += hex.data();
  }
  return text;
}

Guard::Guard(guint16 port, std::string token, std::string program)
    : port_(port), token_(std::move(token)), program_(std::move(program))
{
}

std::string
Guard::address() const
{
  return "http://127.0.0.1:" + std::to_string(port_) + "/" + token_ + "/";
}

bool
Guard::is_ours(const std::string &host) const
{
  const std::string port = ":" + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

std::optional<std::string>
Guard::admit(SoupServerMessage *message) const
{
  const std::string other_site = "expected a request of the program's own page, got one of another "
                                 "site; open the address that "
                                 + program_ + " printed";
  const auto refuse = [&](guint status, const std::string &text) {
    answer_error(message, status, text);
    return std::nullopt;
  };
  if (!is_ours(header(message, "Host")))
    return refuse(403, "expected the host 127.0.0.1 or localhost in the request, got another; open "
                       "the address that "
                           + program_ + " printed");
  // It may know the token: after the end of an earlier process, it had the port.
  if (!is_of_this_user(message))
    return refuse(403, "expected a request of the user of the program, got another user's");
  const std::string origin = header(message, "Origin");
  if (!origin.empty() && !(origin.starts_with("http://") && is_ours(origin.substr(7))))
    return refuse(403, other_site);
  const std::string path = g_uri_get_path(soup_server_message_get_uri(message));
  const std::size_t slash = path.find('/', 1);
  if (!path.starts_with('/') || slash == std::string::npos
      || !equal(path.substr(1, slash - 1), token_))
    return refuse(404,
                  "there is no such page; the address that " + program_ + " printed is complete");
  std::string rest = path.substr(slash + 1);
  const std::string site = header(message, "Sec-Fetch-Site");
  const bool opens_page = rest.empty() && header(message, "Sec-Fetch-Mode") == "navigate";
  if (!site.empty() && site != "same-origin" && site != "none" && !opens_page)
    return refuse(403, other_site);
  return rest;
}
