// SPDX-License-Identifier: LGPL-2.1-or-later
#include "desk/files.h"

#include "files/replace.h"
#include "text.h"

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace fs = std::filesystem;

namespace desk {

namespace {

using files::folder_of;

constexpr std::string_view kVersion = ".desk~"; ///< and a number and "~"

/// The numbers of the versions that are kept.
std::vector<int>
versions(const std::string &path)
{
  std::vector<int> numbers;
  const std::string stem = fs::path(path).filename().string() + std::string(kVersion);
  std::error_code error;
  for (fs::directory_iterator entry(folder_of(path), error), none; !error && entry != none;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with('~') || name.size() <= stem.size())
      continue;
    const auto number = visuotactile::read_number<int>(
        std::string_view(name).substr(stem.size(), name.size() - 1 - stem.size()));
    if (number && *number > 0 && *number < 1'000'000'000)
      numbers.push_back(*number);
  }
  return numbers;
}

} // namespace

tl::expected<std::string, std::string>
keep_version(const std::string &path, int most)
{
  std::error_code error;
  if (!fs::exists(path, error))
    return {};
  const std::vector<int> numbers = versions(path);
  int newest = 0;
  for (const int number : numbers)
    newest = std::max(newest, number);
  const auto named = [&](int number) {
    return path + std::string(kVersion) + std::to_string(number) + "~";
  };
  newest++;
  fs::create_hard_link(path, named(newest), error); // the new file has another inode
  if (error)
    fs::copy_file(path, named(newest), error);
  if (error) {
    std::error_code ignored;
    fs::remove(named(newest), ignored);
    return tl::unexpected("'" + named(newest) + "': " + error.message());
  }
  for (const int number : numbers)
    if (number <= newest - most)
      fs::remove(named(number), error);
  return fs::path(named(newest)).filename().string();
}

} // namespace desk
