// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/heard.h"

#include "files/regular_file.h"
#include "files/replace.h"
#include "library/track_index.h"
#include "library/web.h"
#include "listen/catalogue.h"

#include <glib.h>

#include <algorithm>
#include <filesystem>
#include <unistd.h>

namespace library {

namespace fs = std::filesystem;

namespace {

std::vector<listen::Entry>
in_folder(const std::string &folder, std::vector<std::string> &complaints)
{
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (const std::string path = entry->path().string(); path.ends_with(listen::kEntryEnding))
      paths.push_back(path);
  std::ranges::sort(paths);
  std::vector<listen::Entry> entries;
  for (const std::string &path : paths) {
    if (entries.size() >= listen::Catalogue::kMostFilms)
      break;
    auto entry = listen::Entry::open(path);
    if (entry)
      entries.push_back(*std::move(entry));
    else
      complaints.push_back("'" + path + "': " + entry.error());
  }
  return entries;
}

/// Keeps it for the next time, if it can be written.
void
keep(const std::string &path, const std::string &bytes)
{
  const std::string part = path + ".part" + std::to_string(getpid());
  auto file = files::create(part);
  if (!file)
    return;
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t piece = write(file->descriptor(), bytes.data() + done, bytes.size() - done);
    if (piece <= 0)
      break;
    done += static_cast<std::size_t>(piece);
  }
  if (done != bytes.size() || !files::replace(*file, part, path))
    unlink(part.c_str());
}

/// An entry that was fetched once and is still the listed one; else of the server.
tl::expected<listen::Entry, std::string>
listed(const std::string &where, const IndexEntry &listed, GCancellable *stop)
{
  g_autofree gchar *folder
      = g_build_filename(g_get_user_cache_dir(), "visuotactile", "heard", nullptr);
  const std::string path = (fs::path(folder) / (listed.heard_sum + listen::kEntryEnding)).string();
  if (const auto kept = files::read(path, listen::kMostEntry);
      kept && content_sum(*kept) == listed.heard_sum)
    if (auto entry = listen::Entry::open(path))
      return entry;
  g_autofree gchar *escaped = g_uri_escape_string(listed.heard.c_str(), "/", FALSE);
  auto bytes = fetch(where + escaped, listen::kMostEntry, stop);
  if (!bytes)
    return tl::unexpected(bytes.error());
  if (content_sum(*bytes) != listed.heard_sum)
    return tl::unexpected(
        "'" + where + escaped
        + "' is not what the index lists; make it again with tactile-track index");
  if (g_mkdir_with_parents(folder, 0700) == 0)
    keep(path, *bytes);
  if (auto entry = listen::Entry::open(path))
    return entry;
  return listen::Entry::of(*std::move(bytes));
}

std::vector<listen::Entry>
on_server(std::string where, std::vector<std::string> &complaints, GCancellable *stop)
{
  if (!where.ends_with('/'))
    where += '/';
  const auto index
      = fetch(where + kIndexName, kMostIndex, stop).and_then([](const std::string &text) {
          return read_index(text);
        });
  if (!index) {
    complaints.push_back(index.error());
    return {};
  }
  std::vector<listen::Entry> entries;
  for (const IndexEntry &one : *index) {
    if (one.heard.empty() || entries.size() >= listen::Catalogue::kMostFilms)
      continue;
    if (stop != nullptr && g_cancellable_is_cancelled(stop) != FALSE)
      break;
    auto entry = listed(where, one, stop);
    if (entry)
      entries.push_back(*std::move(entry));
    else
      complaints.push_back(entry.error());
  }
  return entries;
}

} // namespace

std::string
content_sum(const std::string &bytes)
{
  g_autofree gchar *sum = g_compute_checksum_for_data(
      G_CHECKSUM_SHA256, reinterpret_cast<const guchar *>(bytes.data()), bytes.size());
  return sum;
}

std::vector<listen::Entry>
heard_entries(const std::string &where, std::vector<std::string> &complaints, GCancellable *stop)
{
  if (where.empty())
    return {};
  return is_address(where) ? on_server(where, complaints, stop) : in_folder(where, complaints);
}

} // namespace library
