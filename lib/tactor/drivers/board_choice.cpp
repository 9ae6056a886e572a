// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/board_choice.h"

#include <algorithm>
#include <utility>

namespace tactor {

namespace {

/// A device's strings may hold anything, and go into messages.
std::string
printable(std::string text)
{
  text.resize(std::min<std::size_t>(text.size(), 80));
  std::ranges::replace_if(
      text, [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

} // namespace

std::string
describe(const SerialDevice &device)
{
  return printable(device.name) + " ("
         + (device.serial.empty() ? "" : "serial " + printable(device.serial) + ", ") + "at "
         + device.bus_path + ")";
}

std::string
describe(const std::vector<SerialDevice> &devices)
{
  std::string text;
  for (const SerialDevice &device : devices)
    text += (text.empty() ? "" : ", ") + describe(device);
  return text;
}

BoardChoice
choose_boards(const std::vector<SerialDevice> &all, const std::string &name, bool asks_a_stranger,
              const KnownBoards &known)
{
  BoardChoice choice;
  for (const SerialDevice &device : all) {
    const bool is_wanted
        = name.empty() ? known.has(device) : device.serial == name || device.bus_path == name;
    if (is_wanted)
      choice.wanted.push_back(device);
    else if (name.empty())
      choice.passed_over.push_back(device);
  }
  if (!choice.wanted.empty())
    return choice;
  std::vector<SerialDevice> &others = choice.passed_over;
  const auto may_be_one = [&](const SerialDevice &device) {
    return !known.has_refused(device);
  };
  const auto count = std::ranges::count_if(others, may_be_one);
  if (asks_a_stranger && count == 1) {
    const auto only = std::ranges::find_if(others, may_be_one);
    choice.stranger = std::move(*only);
    others.erase(only);
  } else {
    choice.may_lack_one = count > 0;
  }
  return choice;
}

BoardIdentity::BoardIdentity(SerialDevice board, const std::string &name,
                             const std::vector<SerialDevice> &all)
    : board_(std::move(board)), any_in_socket_(name == board_.bus_path && name != board_.serial),
      is_of_its_socket_(any_in_socket_ || board_.serial.empty())
{
  look_at(all);
}

void
BoardIdentity::look_at(const std::vector<SerialDevice> &all)
{
  is_of_its_socket_ = is_of_its_socket_ || std::ranges::any_of(all, [this](const auto &other) {
                        return is_same(other) && other.bus_path != board_.bus_path;
                      });
}

void
BoardIdentity::is_now(SerialDevice board)
{
  board_ = std::move(board);
}

std::optional<SerialDevice>
BoardIdentity::find(const std::vector<SerialDevice> &all) const
{
  std::optional<SerialDevice> found;
  for (const SerialDevice &device : all) {
    if (!any_in_socket_ && !is_same(device))
      continue;
    if (device.bus_path == board_.bus_path)
      return device;
    if (!is_of_its_socket_ && !found)
      found = device;
  }
  return found;
}

bool
BoardIdentity::is_same(const SerialDevice &other) const
{
  return other.vendor == board_.vendor && other.product == board_.product
         && other.serial == board_.serial;
}

} // namespace tactor
