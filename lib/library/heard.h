// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "listen/entry.h"

#include <gio/gio.h>

#include <string>
#include <vector>

namespace library {

/// Entries of films that are known by their sound: the files *.heard of a folder, or those that the
/// index of a library on a web server lists, which are kept in $XDG_CACHE_HOME/visuotactile/heard.
/// Unusable entries are skipped, with a complaint. Slow; any thread may call it.
std::vector<listen::Entry> heard_entries(const std::string &where,
                                         std::vector<std::string> &complaints,
                                         GCancellable *stop = nullptr);

/// SHA-256 of an entry's content, in hexadecimal: its name in the cache.
std::string content_sum(const std::string &bytes);

} // namespace library
