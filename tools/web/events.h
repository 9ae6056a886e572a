// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <libsoup/soup.h>

#include <functional>
#include <list>
#include <string>

/// The streams of events of all pages. Main context's thread.
class Events
{
public:
  /// `left` is called with the page when one of its streams has ended.
  explicit Events(std::function<void(const std::string &page)> left);
  ~Events();
  Events(const Events &) = delete;
  Events &operator=(const Events &) = delete;

  /// Makes the answer a stream, that begins with these events.
  void add(SoupServerMessage *message, const std::string &page, const std::string &first);

  /// To all pages.
  void send(const std::string &events);

  /// An event as it is sent.
  static std::string event(const char *name, const std::string &json);

private:
  struct Stream
  {
    Events *of;
    SoupServerMessage *message; ///< a reference
    std::string page;
  };
  static void write(SoupServerMessage *message, const std::string &text);
  void ended(Stream *stream);

  std::function<void(const std::string &)> left_;
  std::list<Stream> streams_;
  guint tick_;
};
