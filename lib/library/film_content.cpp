// SPDX-License-Identifier: LGPL-2.1-or-later
#include "library/film_content.h"

#include "files/regular_file.h"

#include <glib.h>

#include <algorithm>
#include <memory>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace library {

namespace {

constexpr off_t kPart = 64 << 10;

} // namespace

std::string
film_content(const std::string &film)
{
  const auto file = files::open_regular(film);
  struct stat found
  {
  };
  if (!file || fstat(file->descriptor(), &found) != 0)
    return "";
  const std::unique_ptr<GChecksum, void (*)(GChecksum *)> sum(g_checksum_new(G_CHECKSUM_SHA256),
                                                              g_checksum_free);
  const std::string size = std::to_string(found.st_size);
  g_checksum_update(sum.get(), reinterpret_cast<const guchar *>(size.data()),
                    static_cast<gssize>(size.size()));
  std::vector<guchar> bytes(kPart);
  for (const off_t from :
       { off_t{ 0 }, found.st_size / 2, found.st_size - std::min(found.st_size, kPart) }) {
    off_t count = 0;
    while (count < kPart) {
      const ssize_t piece = pread(file->descriptor(), bytes.data() + count,
                                  static_cast<std::size_t>(kPart - count), from + count);
      if (piece < 0)
        return "";
      if (piece == 0)
        break;
      count += piece;
    }
    g_checksum_update(sum.get(), bytes.data(), count);
  }
  return g_checksum_get_string(sum.get());
}

std::optional<FileVersion>
file_version(const std::string &path)
{
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error)
    return std::nullopt;
  const auto changed = std::filesystem::last_write_time(path, error);
  return error ? std::nullopt : std::optional(FileVersion{ .size = size, .changed = changed });
}

} // namespace library
