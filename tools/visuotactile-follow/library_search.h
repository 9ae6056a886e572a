// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "library/library.h"

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

/// Looks for a film's track in the user's library: in a folder at once, on a server without waiting
/// for it. Of the main context's thread.
class LibrarySearch
{
public:
  struct Result
  {
    std::optional<library::FoundTrack> found{};
    library::Library::Complaints complaints{};
  };

  /// `library` must stay.
  LibrarySearch(const library::Library &library, std::string film,
                std::optional<tactile::Time> duration, library::Library::Skipped skipped);
  /// Ends a request.
  ~LibrarySearch();
  LibrarySearch(const LibrarySearch &) = delete;
  LibrarySearch &operator=(const LibrarySearch &) = delete;

  /// Null while it looks.
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
