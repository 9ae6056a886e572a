// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/serial/tty_use.h"

#include "tactor/serial/legible.h"
#include "tactor/serial/small_file.h"
#include "text.h"

#include <algorithm>
#include <map>
#include <optional>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <system_error>
#include <vector>

namespace tactor {

using visuotactile::read_number;

namespace {

namespace fs = std::filesystem;

/// A serial line of the kernel's.
struct Tty
{
  std::string name; ///< "ttyACM0"
  dev_t number = 0; ///< of its node
  fs::path module;  ///< of its driver, in sysfs; empty if it is built in
  bool is_ours = false;
};

/// The entries of a folder; none if it cannot be read.
std::vector<fs::path>
entries(const fs::path &folder)
{
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    found.push_back(entry->path());
  return found;
}

/// "188:0"
dev_t
device_number(const std::string &text)
{
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    return 0;
  const auto major_number = read_number<unsigned>(std::string_view(text).substr(0, colon));
  const auto minor_number = read_number<unsigned>(std::string_view(text).substr(colon + 1));
  return major_number && minor_number ? makedev(*major_number, *minor_number) : 0;
}

/// All serial lines of devices. A line of cdc_acm belongs to an interface ("1-2:1.0"), a line of
/// usb-serial to a port of one ("1-2:1.0/ttyUSB0").
std::vector<Tty>
list_ttys(const std::string &bus_path, int interface, const SystemRoots &roots)
{
  const std::string number = "." + std::to_string(interface);
  std::vector<Tty> ttys;
  for (const fs::path &entry : entries(roots.sys / "class/tty")) {
    std::error_code error;
    const fs::path device = fs::canonical(entry / "device", error);
    if (error)
      continue; // a console or pty
    std::error_code built_in;
    ttys.push_back({ .name = entry.filename(),
                     .number = device_number(small_file(entry / "dev")),
                     .module = fs::canonical(device / "driver/module", built_in),
                     .is_ours = std::ranges::any_of(device, [&](const fs::path &part) {
                       return part.native().starts_with(bus_path + ":")
                              && part.native().ends_with(number);
                     }) });
  }
  return ttys;
}

std::string
process_name(const fs::path &process)
{
  const std::string name = legible(small_file(process / "comm"));
  return (name.empty() ? "a program" : name) + " (process " + process.filename().native() + ")";
}

/// The process that has each of the lines open, among those whose files may be seen.
std::map<dev_t, std::string>
seen_users(const std::vector<Tty> &ttys, const SystemRoots &roots)
{
  std::map<dev_t, std::string> users;
  for (const fs::path &process : entries(roots.proc)) {
    if (!read_number<unsigned>(process.filename().native()))
      continue;
    for (const fs::path &file : entries(process / "fd")) {
      std::error_code error;
      // Not stat() first: it blocks on a network file system that is gone.
      if (!fs::read_symlink(file, error).native().starts_with("/dev/"))
        continue;
      struct stat status
      {
      };
      if (stat(file.c_str(), &status) == 0 && S_ISCHR(status.st_mode)
          && std::ranges::find(ttys, status.st_rdev, &Tty::number) != ttys.end())
        users.emplace(status.st_rdev, process_name(process));
    }
  }
  return users;
}

/// The running process that holds a UUCP lock on a line, as terminal programs do.
std::optional<std::string>
locked_by(const std::string &tty, const SystemRoots &roots)
{
  const std::string text = small_file(roots.locks / ("LCK.." + tty));
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos)
    return std::nullopt;
  const auto process = read_number<unsigned>(
      std::string_view(text).substr(begin, text.find_first_of(" \n", begin) - begin));
  std::error_code error;
  if (!process || !fs::exists(roots.proc / std::to_string(*process), error))
    return std::nullopt; // stale
  return process_name(roots.proc / std::to_string(*process));
}

} // namespace

LineUse
tty_use(const std::string &bus_path, int interface, const SystemRoots &roots)
{
  using Kind = LineUse::Kind;
  const std::vector<Tty> ttys = list_ttys(bus_path, interface, roots);
  if (std::ranges::none_of(ttys, &Tty::is_ours))
    return {};
  const std::map<dev_t, std::string> users = seen_users(ttys, roots);
  for (const Tty &tty : ttys) {
    if (!tty.is_ours)
      continue;
    if (const auto user = users.find(tty.number); user != users.end())
      return { Kind::certain, user->second + " has " + tty.name + " open" };
    if (const std::optional<std::string> user = locked_by(tty.name, roots))
      return { Kind::certain, *user + " has locked " + tty.name };
    if (tty.module.empty())
      continue;
    // The driver holds a reference to its module for each open line.
    const int open = read_number<int>(small_file(tty.module / "refcnt")).value_or(0);
    int seen = 0;
    int unaccounted = 0; // other lines that may be the open ones
    for (const Tty &other : ttys)
      if (other.module == tty.module) {
        seen += users.contains(other.number);
        unaccounted += !other.is_ours && !users.contains(other.number);
      }
    if (open > seen)
      return unaccounted == 0
                 ? LineUse{ Kind::certain, "a program of another user has " + tty.name + " open" }
                 : LineUse{ Kind::perhaps,
                            "a program of another user may have " + tty.name + " open" };
  }
  return {};
}

bool
has_no_driver(const std::string &bus_path, int interface, const SystemRoots &roots)
{
  const fs::path device = roots.sys / "bus/usb/devices" / bus_path;
  const std::string configuration = small_file(device / "bConfigurationValue");
  const fs::path folder = device.native() + ":" + configuration + "." + std::to_string(interface);
  std::error_code error;
  return fs::exists(folder, error) && !fs::is_symlink(folder / "driver", error);
}

} // namespace tactor
