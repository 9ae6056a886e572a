// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "tactor/command_trace.h"
#include "tactor/driver.h"

#include <memory>

/// The driver and trace of a play.
struct TactorOutput
{
  std::unique_ptr<tactor::Driver> driver;      ///< open
  std::unique_ptr<tactor::CommandTrace> trace; ///< may be null
};
