// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "connections.h"
#include "guard.h"
#include "site.h"

#include <memory>
#include <string>

/// The port of a file, above those that Linux gives away by itself. A page that was killed, or
/// whose server was, has edits in storage of its origin, which the next one finds at the same port.
guint16 usual_port(const std::string &file);

/// Runs the main loop until SIGINT, SIGTERM or SIGHUP.
void run_until_signal();

/// The HTTP server, which admits and limits requests. For the main context's thread.
class Server
{
public:
  struct Settings
  {
    guint16 port;               ///< as Connections
    guint16 usual;              ///< likewise
    const char *program;        ///< which printed the address, for messages
    bool inline_styles = false; ///< scripts of others set styles in the page
    std::string token; ///< of an earlier process, whose pages may still be open; empty: a new one
  };
  /// Throws std::runtime_error.
  Server(const Settings &settings, Site &site);
  ~Server();
  Server(const Server &) = delete;
  Server &operator=(const Server &) = delete;

  /// With the token.
  std::string address() const
  {
    return guard_->address();
  }

private:
  void on_headers(SoupServerMessage *message);
  void on_request(SoupServerMessage *message);

  Site &site_;
  bool inline_styles_;
  SoupServer *server_;
  std::unique_ptr<Connections> connections_;
  std::unique_ptr<Guard> guard_;
};
