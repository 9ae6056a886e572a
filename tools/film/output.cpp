// SPDX-License-Identifier: LGPL-2.1-or-later
#include "output.h"

#include "files/replace.h"
#include "text.h"
#include "translation.h"

#include <glib.h>

#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kEnding = ".part";

/// What the names of an output's parts on this machine begin with. Folders may be shared between
/// machines, whose process ids mean nothing here.
std::string
part_stem(const std::string &name)
{
  return "." + name + "." + g_get_host_name() + ".";
}

/// Removes parts that killed processes of this machine have left.
void
remove_stale_parts(const fs::path &directory, const std::string &stem)
{
  std::error_code error;
  for (const auto &entry : fs::directory_iterator(directory.empty() ? "." : directory, error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with(kEnding))
      continue;
    const auto writer = visuotactile::read_number<pid_t>(std::string_view(name).substr(
        stem.size(), name.size() - std::min(name.size(), stem.size() + kEnding.size())));
    if (writer && *writer > 0 && kill(*writer, 0) != 0 && errno == ESRCH)
      fs::remove(entry.path(), error);
  }
}

} // namespace

Output::Output(const fs::path &directory, const std::string &name)
    : final_(files::target_of(directory / name)),
      part_(final_.parent_path()
            / (part_stem(final_.filename()) + std::to_string(getpid()) + std::string(kEnding)))
{
  remove_stale_parts(final_.parent_path(), part_stem(final_.filename()));
  if (const auto expected = files::expect_regular(final_.string()); !expected)
    throw std::runtime_error(in_text("'{}': {}; move it away or give another --output",
                                     final_.string(), expected.error().reason));
}

Output::~Output()
{
  std::error_code ignored;
  fs::remove(part_, ignored);
}

bool
Output::commit()
{
  std::error_code error;
  if (fs::file_size(part_, error) == 0 || error)
    return false;
  const auto replaced = files::open_regular(part_).and_then(
      [this](const files::File &part) { return files::replace(part, part_, final_); });
  if (!replaced)
    throw std::runtime_error(
        in_text("cannot write '{}': {}", final_.string(), replaced.error().reason));
  return true;
}

void
prepare_directory(const fs::path &directory)
{
  std::error_code error;
  fs::create_directories(directory, error);
  if (error)
    throw std::runtime_error(
        in_text("cannot make the folder '{}': {}", directory.string(), error.message()));
  if (!fs::is_directory(directory, error))
    throw std::runtime_error(
        in_text("'{}' is not a folder; expected one for --output", directory.string()));
  if (access(directory.c_str(), W_OK) != 0)
    throw std::runtime_error(in_text("cannot write to the folder '{}': {}", directory.string(),
                                     std::generic_category().message(errno)));
}
