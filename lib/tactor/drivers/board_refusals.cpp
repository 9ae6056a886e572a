// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tactor/drivers/board_refusals.h"

#include "tactor/drivers/board_choice.h"

namespace tactor {

using Kind = DriverError::Kind;

std::string
describe(const std::vector<int> &numbers)
{
  std::string text;
  for (const int number : numbers)
    text += (text.empty() ? "" : ", ") + std::to_string(number);
  return text;
}

std::optional<DriverError>
refusal_of_use(const SerialDevice &device, const LineUse &use, bool is_wanted)
{
  if (use.kind == LineUse::Kind::free || (use.kind == LineUse::Kind::perhaps && is_wanted))
    return std::nullopt;
  return DriverError{ Kind::busy, describe(device) + " is in use by another program: " + use.by
                                      + "; close that first" };
}

std::optional<DriverError>
refusal_of_board(const SerialDevice &device, const FirmataBoard &board, int needed,
                 bool needs_watchdog)
{
  const std::vector<int> pins = board.pins();
  const auto count = static_cast<int>(pins.size());
  if (count == 0)
    return DriverError{ Kind::settings,
                        describe(device) + ": expected pins with pulse-width modulation, and "
                            + board.firmware()
                            + " has none; flash StandardFirmata, or take a board that has some" };
  if (count < needed)
    return DriverError{ Kind::settings, describe(device) + " has " + std::to_string(count)
                                            + " pins with pulse-width modulation (" + describe(pins)
                                            + "), but " + std::to_string(needed)
                                            + " tactors are wanted; set mapping to tactors below "
                                            + std::to_string(count)
                                            + ", or take a board with more" };
  if (needs_watchdog && !board.has_watchdog())
    return DriverError{ Kind::settings, describe(device) + ": expected the seat firmware, got "
                                            + board.firmware()
                                            + "; flash it (docs/hardware), or use driver=firmata" };
  return std::nullopt;
}

DriverError
summary(const std::vector<DriverError> &refusals)
{
  std::string text;
  for (const DriverError &refusal : refusals)
    text += (text.empty() ? "" : "; ") + refusal.text;
  return { refusals.front().kind, text };
}

DriverError
refusal_of_none(const std::string &name, const std::vector<SerialDevice> &devices, bool may_be_one)
{
  if (name.empty())
    return { may_be_one ? Kind::not_asked : Kind::not_found,
             devices.empty()
                 ? "no tactor board is plugged in; expected one with StandardFirmata on USB"
                 : "no board that is known to be a tactor board is plugged in" };
  return { Kind::not_found,
           "no tactor board '" + name
               + "' is plugged in; expected the serial number or the bus path of one, and there is "
               + (devices.empty() ? "none" : describe(devices)) };
}

std::string
advice(const std::vector<SerialDevice> &not_asked)
{
  if (not_asked.empty())
    return {};
  const bool is_one = not_asked.size() == 1;
  return "; not probed, as it may be anything, also a 3D printer: " + describe(not_asked) + "; if "
         + (is_one ? "that" : "one of these")
         + " is the chair, name it once, as in visuotactile-play --feel-test --device="
         + not_asked.front().bus_path;
}

void
ReturnRefusals::clear()
{
  last_.reset();
  reported_.clear();
}

bool
ReturnRefusals::add(const DriverError &refusal)
{
  const bool stays = refusal.kind == Kind::settings || refusal.kind == Kind::busy
                     || (last_ && last_->text == refusal.text);
  last_ = refusal;
  return stays && reported_.size() < kMost && reported_.insert(refusal.text).second;
}

bool
ReturnRefusals::is_final() const
{
  return last_ && last_->kind == Kind::settings;
}

} // namespace tactor
