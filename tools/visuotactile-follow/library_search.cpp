// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library_search.h"

#include <exception>
#include <utility>

LibrarySearch::LibrarySearch(const library::Library &library, std::string film,
                             std::optional<tactile::Time> duration,
                             library::Library::Skipped skipped)
    : stop_(g_cancellable_new())
{
  auto look = [this, &library, film = std::move(film), duration, skipped = std::move(skipped)] {
    try {
      result_.found = library.stored(film, duration, skipped, result_.complaints, stop_);
    } catch (const std::exception &error) {
      result_.complaints.library = error.what();
    }
    is_done_ = true;
  };
  if (library.is_on_server())
    thread_ = std::thread(std::move(look));
  else
    look();
}

LibrarySearch::~LibrarySearch()
{
  g_cancellable_cancel(stop_);
  if (thread_.joinable())
    thread_.join();
  g_object_unref(stop_);
}
