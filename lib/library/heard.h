// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/entry.h"

#include <gio/gio.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace library {

/// Entries of films that are known by their sound: the files *.heard of a folder, or those that the
/// index of a library on a web server lists, which are kept in $XDG_CACHE_HOME/visuotactile/heard.
/// Unusable entries, those beyond kMostHeard of a server, and those that the cache cannot keep are
/// skipped, with a complaint. Slow; any thread may call it.
std::vector<listen::Entry> heard_entries(const std::string &where,
                                         std::vector<std::string> &complaints,
                                         GCancellable *stop = nullptr);

/// Bytes of a server's entries, and of the cache.
inline constexpr std::uintmax_t kMostHeard = std::uintmax_t{ 8 } << 30;

/// Notes in a file's time of access that it is used. Its time of change stays: programs that have
/// the entry open read on.
void mark_used(const std::string &path);

/// Removes files of the cache beyond `most_bytes`, but none in use; the one that was used last is
/// removed last.
void remove_unused(const std::string &folder, const std::set<std::string> &used,
                   std::uintmax_t most_bytes);

/// SHA-256 of an entry's content, in hexadecimal: its name in the cache.
std::string content_sum(const std::string &bytes);

} // namespace library
