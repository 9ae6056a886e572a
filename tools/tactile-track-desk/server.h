// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "connections.h"
#include "guard.h"
#include "routes.h"

#include <memory>
#include <string>

/// The HTTP server, which admits and limits requests. For the main context's thread.
class Server
{
public:
  /// Throws std::runtime_error. `port`, `usual`: as Connections.
  Server(guint16 port, guint16 usual, Routes &routes);
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

  Routes &routes_;
  SoupServer *server_;
  std::unique_ptr<Connections> connections_;
  std::unique_ptr<Guard> guard_;
};
