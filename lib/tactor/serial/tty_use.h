// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/serial/line_use.h"
#include "tactor/serial/system_roots.h"

#include <string>

namespace tactor {

/// Whether a program has the terminal of an interface of the USB device at this bus path ("1-2.3")
/// open. Nothing is opened for that: to open a terminal raises DTR, which resets boards and 3D
/// printers.
///
/// What is looked at: open files of all processes whose files may be seen, by device number; lock
/// files of the UUCP kind (/run/lock/LCK..ttyUSB0) of living processes; and how many terminals of
/// the kernel's driver are open in all (its module's count of references), of which those that
/// nobody is seen to have are of other users' programs. A device that has no terminal, since no
/// driver or another one has it, is free.
LineUse tty_use(const std::string &bus_path, int interface, const SystemRoots &roots = {});

/// Whether an interface of the USB device at this bus path has no driver: as it is left by a
/// process that was killed while it had it.
bool has_no_driver(const std::string &bus_path, int interface, const SystemRoots &roots = {});

} // namespace tactor
