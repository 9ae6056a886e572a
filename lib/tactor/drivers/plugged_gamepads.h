// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/drivers/gamepads.h"

#include <filesystem>
#include <vector>

namespace tactor {

/// The gamepads with rumble motors that the kernel knows, in the order of their paths. It opens
/// none and loads no SDL. Empty in a build without gamepads. Any thread.
std::vector<Gamepad> plugged_gamepads(const std::filesystem::path &sys_input = "/sys/class/input");

} // namespace tactor
