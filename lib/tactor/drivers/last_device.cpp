// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/last_device.h"

#include "files/regular_file.h"
#include "files/whole_file.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <system_error>

namespace tactor {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostBytes = 4096;

/// The driver of a line has no other letters.
bool
is_word(const std::string &text)
{
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= 'a' && c <= 'z'; });
}

/// It may be shown.
bool
is_plain(const std::string &text)
{
  return std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

bool
is_valid(const LastDevice &device)
{
  return is_word(device.driver) && is_plain(device.device) && is_plain(device.board)
         && !device.board.empty();
}

} // namespace

fs::path
state_file(const char *file)
{
  const char *state = std::getenv("XDG_STATE_HOME");
  const char *home = std::getenv("HOME");
  fs::path folder = state ? state : "";
  if (!folder.is_absolute()) // ignored, as the XDG specification says
    folder = home ? fs::path(home) / ".local/state" : fs::path();
  return folder.is_absolute() ? folder / "visuotactile" / file : fs::path();
}

std::optional<LastDevice>
last_device(const fs::path &file)
{
  const tl::expected<std::string, files::Error> text = files::read(file, kMostBytes);
  if (!text)
    return std::nullopt;
  std::istringstream lines(*text);
  LastDevice last;
  std::string rest;
  const bool read = std::getline(lines, last.driver) && std::getline(lines, last.device)
                    && std::getline(lines, last.board) && !std::getline(lines, rest);
  return read && is_valid(last) ? std::optional(last) : std::nullopt;
}

void
remember_device(const LastDevice &device, const fs::path &file)
{
  if (file.empty() || !is_valid(device) || last_device(file) == device)
    return;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  // One that cannot be written is not offered.
  (void)files::replace_file(file,
                            device.driver + "\n" + device.device + "\n" + device.board + "\n");
}

} // namespace tactor
