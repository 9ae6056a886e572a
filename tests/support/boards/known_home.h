// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "support/temporary_file.h"
#include "tactor/drivers/known_boards.h"

#include <cstdlib>
#include <initializer_list>

/// A home in which these devices are known to be tactor boards, for this process.
class KnownHome
{
public:
  explicit KnownHome(std::initializer_list<tactor::SerialDevice> devices = {})
  {
    setenv("XDG_STATE_HOME", folder_.path.c_str(), 1);
    tactor::KnownBoards boards(tactor::KnownBoards::default_file());
    for (const tactor::SerialDevice &device : devices)
      boards.add(device);
  }

private:
  const TemporaryFolder folder_;
};
