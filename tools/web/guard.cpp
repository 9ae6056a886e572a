// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guard.h"

#include "soup.h"
#include "translation.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <netinet/in.h>
#include <sstream>
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

/// An end of a connection as the kernel writes it, such as 0100007F:1F90. Empty if it is unknown.
std::string
end_of(GSocketAddress *address)
{
  sockaddr_in end{};
  if (!address || !g_socket_address_to_native(address, &end, sizeof end, nullptr))
    return "";
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%08X:%04X", end.sin_addr.s_addr, ntohs(end.sin_port));
  return text.data();
}

/// Whether the other end of a connection on this computer is another user's, or nobody's because it
/// was closed, by the kernel's table (proc(5): /proc/net/tcp). Without a table nobody is refused.
bool
is_of_another_user(SoupServerMessage *message)
{
  const std::string remote = end_of(soup_server_message_get_remote_address(message));
  const std::string local = end_of(soup_server_message_get_local_address(message));
  std::ifstream table("/proc/net/tcp");
  if (!table)
    return false;
  for (std::string line; std::getline(table, line);) {
    std::istringstream row(line);
    std::string number, from, to, state, queues, timer, retransmits;
    unsigned user = 0;
    unsigned timeout = 0;
    unsigned inode = 0;
    row >> number >> from >> to >> state >> queues >> timer >> retransmits >> user >> timeout
        >> inode;
    if (from == remote && to == local)
      return user != geteuid() || inode == 0;
  }
  return true;
}

} // namespace

std::string
random_token()
{
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error(_("the system has no random numbers"));
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
  const std::string origin = header(message, "Origin");
  if (!origin.empty() && !(origin.starts_with("http://") && is_ours(origin.substr(7))))
    return refuse(403, other_site);
  const std::string path = g_uri_get_path(soup_server_message_get_uri(message));
  const std::size_t slash = path.find('/', 1);
  if (!path.starts_with('/') || slash == std::string::npos
      || !equal(path.substr(1, slash - 1), token_))
    return refuse(404,
                  "there is no such page; the address that " + program_ + " printed is complete");
  // A browser sends the token to any program that has the port after the end of this one.
  if (is_of_another_user(message))
    return refuse(403, "expected a request of the user who runs " + program_
                           + ", got another user's; start the browser as that user");
  std::string rest = path.substr(slash + 1);
  const std::string site = header(message, "Sec-Fetch-Site");
  const bool opens_page = rest.empty() && header(message, "Sec-Fetch-Mode") == "navigate";
  if (!site.empty() && site != "same-origin" && site != "none" && !opens_page)
    return refuse(403, other_site);
  return rest;
}
