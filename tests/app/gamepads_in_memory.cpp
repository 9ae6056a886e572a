// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A module in the place of SDL's: one gamepad, whose rumble is a line in the file GAMEPAD_LOG.
#include "tactor/drivers/gamepads.h"

#include <cstdlib>
#include <fstream>

namespace {

class Port final : public tactor::GamepadPort
{
public:
  int motors() const override
  {
    return 2;
  }
  bool stops_with_process() const override
  {
    return true;
  }
  bool rumble(const tactor::GamepadLevels &levels, tactor::Time) override
  {
    const char *path = std::getenv("GAMEPAD_LOG");
    if (path != nullptr && (levels[0] > 0 || levels[1] > 0))
      std::ofstream(path, std::ios::app) << levels[0] << ' ' << levels[1] << std::endl;
    return true;
  }
  bool is_there() override
  {
    return true;
  }
};

class OnePad final : public tactor::Gamepads
{
public:
  std::vector<tactor::Gamepad> list() override
  {
    return { { .id = 1, .name = "Stand-in Gamepad", .path = "/dev/input/event3" } };
  }
  std::unique_ptr<tactor::GamepadPort> open(const tactor::Gamepad &) override
  {
    return std::make_unique<Port>();
  }
  void update() override
  {
  }
};

} // namespace

extern "C" __attribute__((visibility("default"))) tactor::Gamepads *
visuotactile_make_gamepads(std::string &)
{
  return new OnePad;
}
