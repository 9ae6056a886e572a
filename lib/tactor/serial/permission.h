// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/system_roots.h"

#include <string>

namespace tactor {

/// Why the user may not open the device at this bus path ("1-2.3"), and the commands that change
/// it, in one line. The udev rule is not installed, or was not applied to the device, or grants the
/// device to a local session only, not over ssh.
std::string permission_advice(const std::string &bus_path, const SystemRoots &roots = {});

} // namespace tactor
