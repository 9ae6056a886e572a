// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "library/library.h"

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

/// Searches the user's library for a film's track: a folder at once, a server in the background.
/// Main context's thread.
class LibrarySearch
{
public:
  struct Result
  {
    std::optional<library::FoundTrack> found{};
    library::Library::Complaints complaints{};
  };

  /// `library` must outlive this.
  LibrarySearch(const library::Library &library, std::string film,
                std::optional<tactile::Time> duration, library::Library::Skipped skipped);
  /// Cancels a request.
  ~LibrarySearch();
  LibrarySearch(const LibrarySearch &) = delete;
  LibrarySearch &operator=(const LibrarySearch &) = delete;

  /// Null during the search.
  const Result *result() const
  {
    return is_done_ ? &result_ : nullptr;
  }

private:
  Result result_;
  std::atomic<bool> is_done_ = false;
  GCancellable *stop_;
  std::thread thread_;
};
