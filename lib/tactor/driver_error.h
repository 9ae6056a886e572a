// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace tactor {

/// An error of a board or of a driver's file. The text says what was expected, what came and what
/// to do.
struct DriverError
{
  enum class Kind
  {
    not_found,  ///< no such driver or no such board
    not_asked,  ///< what is there may be a board, or anything else
    busy,       ///< another program has it
    permission, ///< the user may not open it
    settings,   ///< the configuration does not fit the board
    lost,       ///< the board went away
    failed,     ///< anything else
  };

  Kind kind = Kind::failed;
  std::string text; ///< one line
};

} // namespace tactor
