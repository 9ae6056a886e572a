// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <optional>
#include <string>

/// A secret of 32 hexadecimal digits. Throws std::runtime_error.
std::string random_token();

/// Admits requests, and limits them. The browser of the user is trusted with the token; other pages
/// in it and other users' programs are not, even with it.
class Guard
{
public:
  /// `program` printed the address.
  Guard(guint16 port, std::string token, std::string program);

  /// "http://127.0.0.1:PORT/TOKEN/"
  std::string address() const;

  /// The path after the token. None: the request was refused and is answered.
  std::optional<std::string> admit(SoupServerMessage *message) const;

private:
  bool is_ours(const std::string &host) const;

  guint16 port_;
  std::string token_;
  std::string program_;
};
