// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "follow/players/player.h"

#include <tl/expected.hpp>

#include <memory>

namespace follow {

/// mpv at its socket (--input-ipc-server). The error is one line.
tl::expected<std::unique_ptr<Player>, std::string> open_mpv(const std::string &socket,
                                                            PlayerEvents events);

} // namespace follow
