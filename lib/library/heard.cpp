// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/heard.h"

#include "files/regular_file.h"
#include "files/whole_file.h"
#include "library/track_index.h"
#include "library/web.h"
#include "listen/catalogue.h"

#include <glib.h>

#include <algorithm>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <utility>

namespace library {

namespace fs = std::filesystem;

namespace {

bool
stops(GCancellable *stop)
{
  return stop != nullptr && g_cancellable_is_cancelled(stop) != FALSE;
}

/// Puts the name of a file before an error.
auto
named(const std::string &name)
{
  return [name](const std::string &error) {
    return "'" + name + "': " + error;
  };
}

std::vector<listen::Entry>
in_folder(const std::string &folder, std::vector<std::string> &complaints, GCancellable *stop)
{
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (const std::string path = entry->path().string(); path.ends_with(listen::kEntryEnding))
      paths.push_back(path);
  if (error)
    complaints.push_back("'" + folder + "': " + error.message());
  std::ranges::sort(paths);
  std::vector<listen::Entry> entries;
  for (const std::string &path : paths) {
    if (entries.size() >= listen::Catalogue::kMostFilms || stops(stop))
      break;
    auto entry = listen::Entry::open(path).map_error(named(path));
    if (entry)
      entries.push_back(*std::move(entry));
    else
      complaints.push_back(entry.error());
  }
  return entries;
}

std::string
kept_folder()
{
  g_autofree gchar *folder
      = g_build_filename(g_get_user_cache_dir(), "visuotactile", "heard", nullptr);
  return folder;
}

/// Returns the path of an entry in the cache. It is fetched unless the cache has the listed one,
/// whose name is its sum. Adds the bytes that it has, or were fetched.
tl::expected<std::string, std::string>
kept(const std::string &where, const IndexEntry &listed, std::uintmax_t &count, GCancellable *stop)
{
  const std::string path
      = (fs::path(kept_folder()) / (listed.heard_sum + listen::kEntryEnding)).string();
  std::error_code error;
  if (const auto size = fs::file_size(path, error); !error && listen::Entry::open(path)) {
    count += size;
    mark_used(path);
    return path;
  }
  g_autofree gchar *escaped = g_uri_escape_string(listed.heard.c_str(), "/", FALSE);
  auto bytes = fetch(where + escaped, listen::kMostEntry, stop);
  if (!bytes)
    return tl::unexpected(bytes.error());
  count += bytes->size();
  if (content_sum(*bytes) != listed.heard_sum)
    return tl::unexpected(
        "'" + where + escaped
        + "' is not what the index lists; make it again with tactile-track index");
  if (const auto read = listen::Entry::of(*bytes); !read)
    return tl::unexpected("'" + where + escaped + "': " + read.error());
  g_mkdir_with_parents(kept_folder().c_str(), 0700); // if it fails, so does the next
  if (const auto written = files::replace_file(path, *bytes, files::Readers::user); !written)
    return tl::unexpected(written.error());
  return path;
}

std::vector<listen::Entry>
on_server(std::string where, std::vector<std::string> &complaints, GCancellable *stop)
{
  if (!where.ends_with('/'))
    where += '/';
  const auto index
      = fetch(where + kIndexName, kMostIndex, stop).and_then([&](const std::string &text) {
          return read_index(text).map_error(named(where + kIndexName));
        });
  if (!index) {
    complaints.push_back(index.error());
    return {};
  }
  std::vector<listen::Entry> entries;
  std::set<std::string> used;
  std::uintmax_t bytes = 0;
  std::size_t left_out = 0;
  for (const IndexEntry &one : *index) {
    if (one.heard.empty())
      continue;
    if (stops(stop))
      return entries;
    if (bytes >= kMostHeard || entries.size() >= listen::Catalogue::kMostFilms) {
      left_out++;
      continue;
    }
    const auto path = kept(where, one, bytes, stop);
    if (path && !used.insert(*path).second)
      continue; // two tracks of one entry
    auto entry = path.and_then([&](const std::string &file) {
      return listen::Entry::open(file).map_error(named(where + one.heard));
    });
    if (!entry) {
      complaints.push_back(entry.error());
      continue;
    }
    entries.push_back(*std::move(entry));
  }
  if (left_out > 0)
    complaints.push_back(std::to_string(left_out) + " entries of '" + where
                         + "' are left out: at most 8 GiB are fetched, and at most "
                         + std::to_string(listen::Catalogue::kMostFilms)
                         + " films are listened for; copy those that you want to a folder and "
                           "give that to --tracks");
  remove_unused(kept_folder(), used, kMostHeard);
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

void
mark_used(const std::string &path)
{
  const timespec times[2]
      = { { .tv_sec = 0, .tv_nsec = UTIME_NOW }, { .tv_sec = 0, .tv_nsec = UTIME_OMIT } };
  utimensat(AT_FDCWD, path.c_str(), times, 0); // if it fails, it is removed earlier
}

void
remove_unused(const std::string &folder, const std::set<std::string> &used,
              std::uintmax_t most_bytes)
{
  struct File
  {
    bool is_used;
    std::pair<std::int64_t, std::int64_t> last; ///< time of use: s, ns
    std::uintmax_t size;
    std::string path;
  };
  std::vector<File> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string path = entry->path().string();
    struct stat found
    {
    };
    if (lstat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode))
      files.push_back({ .is_used = used.contains(path),
                        .last = { found.st_atim.tv_sec, found.st_atim.tv_nsec },
                        .size = static_cast<std::uintmax_t>(found.st_size),
                        .path = path });
  }
  std::ranges::sort(files, std::ranges::greater(),
                    [](const File &file) { return std::pair(file.is_used, file.last); });
  std::uintmax_t bytes = 0;
  for (const File &file : files)
    if ((bytes += file.size) > most_bytes && !file.is_used)
      fs::remove(file.path, error);
}

std::vector<listen::Entry>
heard_entries(const std::string &where, std::vector<std::string> &complaints, GCancellable *stop)
{
  if (where.empty())
    return {};
  return is_address(where) ? on_server(where, complaints, stop)
                           : in_folder(where, complaints, stop);
}

} // namespace library
