// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/players/player.h"

#include <gio/gio.h>

#include <memory>

namespace follow {

/// The player of that name on the session bus (org.mpris.MediaPlayer2.NAME). Its position is
/// queried a few times a second while it plays. The bus notifies when it goes away.
std::unique_ptr<Player> open_mpris(GDBusConnection *bus, const std::string &bus_name,
                                   PlayerEvents events);

} // namespace follow
