// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/plugged_gamepads.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

namespace tactor {

#ifdef HAVE_GAMEPAD

namespace {

/// The first line, empty if there is none.
std::string
read_line(const std::filesystem::path &file)
{
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

unsigned
read_hex(const std::filesystem::path &file)
{
  return static_cast<unsigned>(std::strtoul(read_line(file).c_str(), nullptr, 16));
}

/// Whether a bit is set in a file of /sys/class/input/…/capabilities: hexadecimal words of the
/// kernel's unsigned long, the most significant one first.
bool
has_bit(const std::filesystem::path &file, std::size_t bit)
{
  constexpr std::size_t kBits = 8 * sizeof(unsigned long);
  std::istringstream line(read_line(file));
  const std::vector<std::string> words{ std::istream_iterator<std::string>(line), {} };
  if (bit / kBits >= words.size())
    return false;
  const std::string &word = words[words.size() - 1 - bit / kBits];
  return (std::strtoul(word.c_str(), nullptr, 16) >> bit % kBits & 1) != 0;
}

} // namespace

std::vector<Gamepad>
plugged_gamepads(const std::filesystem::path &sys_input)
{
  // linux/input-event-codes.h, linux/input.h
  constexpr std::size_t kButtonGamepad = 0x130;
  constexpr std::size_t kRumble = 0x50;
  constexpr unsigned kBluetooth = 0x05;
  std::vector<Gamepad> gamepads;
  std::error_code none;
  for (std::filesystem::directory_iterator entry(sys_input, none), end; !none && entry != end;
       entry.increment(none)) {
    const std::string node = entry->path().filename();
    const std::filesystem::path device = entry->path() / "device";
    if (!node.starts_with("event") || !has_bit(device / "capabilities/key", kButtonGamepad)
        || !has_bit(device / "capabilities/ff", kRumble))
      continue;
    gamepads.push_back({ .name = read_line(device / "name"),
                         .path = "/dev/input/" + node,
                         .vendor = static_cast<std::uint16_t>(read_hex(device / "id/vendor")),
                         .product = static_cast<std::uint16_t>(read_hex(device / "id/product")),
                         .is_bluetooth = read_hex(device / "id/bustype") == kBluetooth });
  }
  std::ranges::sort(gamepads, {}, &Gamepad::path);
  return gamepads;
}

#else

std::vector<Gamepad>
plugged_gamepads(const std::filesystem::path &)
{
  return {};
}

#endif

} // namespace tactor
