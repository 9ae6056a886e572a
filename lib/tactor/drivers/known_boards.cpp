// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/known_boards.h"

#include "files/regular_file.h"
#include "tactor/drivers/last_device.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <sstream>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace tactor {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestLine = 512; // a serial number has 126 characters at most

std::mutex changing; ///< guards the file within this process

/// The line of a device; empty if it would be no valid line.
std::string
line_of(const SerialDevice &device)
{
  char ids[16];
  std::snprintf(ids, sizeof ids, "%04x:%04x", device.vendor, device.product);
  std::string line
      = ids + (device.serial.empty() ? " at " + device.bus_path : " serial " + device.serial);
  return line.size() > kLongestLine || line.find('\n') != std::string::npos ? "" : line;
}

/// The line of a device that is no tactor board.
std::string
refusal_of(const SerialDevice &device)
{
  const std::string line = line_of(device);
  return line.empty() ? "" : "not " + line;
}

} // namespace

KnownBoards::KnownBoards(fs::path file) : file_(std::move(file))
{
}

fs::path
KnownBoards::default_file()
{
  return state_file("boards");
}

bool
KnownBoards::has(const SerialDevice &device) const
{
  return has_line(line_of(device));
}

bool
KnownBoards::has_refused(const SerialDevice &device) const
{
  return has_line(refusal_of(device));
}

void
KnownBoards::add(const SerialDevice &device)
{
  put(line_of(device), refusal_of(device));
}

void
KnownBoards::refuse(const SerialDevice &device)
{
  put(refusal_of(device), line_of(device));
}

bool
KnownBoards::has_line(const std::string &line) const
{
  return !line.empty() && std::ranges::count(read(), line) > 0;
}

void
KnownBoards::put(const std::string &line, const std::string &instead)
{
  const std::lock_guard lock(changing);
  std::vector<std::string> lines = read();
  if (line.empty() || (!lines.empty() && lines.back() == line))
    return;
  std::erase(lines, instead);
  std::erase(lines, line);
  lines.push_back(line); // most recently used last
  if (lines.size() > kMost)
    lines.erase(lines.begin(), lines.end() - kMost);
  write(lines);
}

std::vector<std::string>
KnownBoards::read() const
{
  std::vector<std::string> lines;
  tl::expected<std::string, files::Error> text = files::read(file_, kMost * kLongestLine);
  if (!text)
    return lines;
  std::istringstream file(*std::move(text));
  for (std::string line; lines.size() < kMost && std::getline(file, line);)
    if (!line.empty())
      lines.push_back(line);
  return lines;
}

/// Atomic.
void
KnownBoards::write(const std::vector<std::string> &lines) const
{
  if (file_.empty())
    return;
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  const fs::path part = file_.native() + "." + std::to_string(getpid()) + ".part";
  {
    std::ofstream file(part);
    for (const std::string &line : lines)
      file << line << '\n';
    if (!file.flush()) {
      fs::remove(part, error);
      return;
    }
  }
  fs::rename(part, file_, error);
}

} // namespace tactor
