// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/line_use.h"
#include "tactor/serial/system_roots.h"

#include <string>

namespace tactor {

/// Whether a program has the terminal of an interface of the USB device at this bus path ("1-2.3")
/// open. Opens no terminal, which would raise DTR and reset boards and 3D printers.
///
/// Reads the open files of all visible processes, by device number, and UUCP locks
/// (/run/lock/LCK..ttyUSB0) of running processes. The reference count of the driver's module has
/// the number of all open terminals; those that are not accounted for belong to programs of other
/// users. A device without a terminal is free.
LineUse tty_use(const std::string &bus_path, int interface, const SystemRoots &roots = {});

/// Whether an interface of the USB device at this bus path has no driver, as after a process that
/// held it was killed.
bool has_no_driver(const std::string &bus_path, int interface, const SystemRoots &roots = {});

} // namespace tactor
