// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/film.h"
#include "film/pipeline.h"

#include <libsoup/soup.h>

#include <list>
#include <memory>

/// Converts the film to WebM for browsers that cannot play it, while it is sent and as fast as the
/// client reads. Main context's thread.
class Proxies
{
public:
  static constexpr std::size_t kMost = 2;

  explicit Proxies(Film film);
  ~Proxies();
  Proxies(const Proxies &) = delete;
  Proxies &operator=(const Proxies &) = delete;

  /// Answers with the film from a time on. Too many answers end the oldest.
  void answer(SoupServerMessage *message, GstClockTime from);

private:
  class Stream;

  Film film_;
  std::list<std::unique_ptr<Stream>> streams_;
};
