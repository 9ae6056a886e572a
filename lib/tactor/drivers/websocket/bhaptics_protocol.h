// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "nanoseconds.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Messages of bHaptics Player's WebSocket, ws://127.0.0.1:15881/v2/feedbacks, as its published
/// clients and servers have them (bhaptics/haptic-library and tact-python, HerpDerpinstine's
/// bHapticsLib, MutenCath's bhaptics-linux).
namespace tactor::bhaptics {

inline constexpr int kPort = 15881;
inline constexpr std::string_view kPath = "/v2/feedbacks?app_id=visuotactile&app_name=visuotactile";

/// Whole percents of a level. Never 1: bhaptics-linux reads numbers up to 1 as parts of the whole.
int intensity(double level);

/// The motors of a position. "VestBack" has 20, row by row from the top left as the wearer has it.
struct Frame
{
  std::string_view position;
  std::vector<int> intensities; ///< of motor 0…, see intensity()
};

/// A message that sets the motors of positions for `duration`. A frame that is all zero ends what
/// this program plays there.
std::string write_submit(std::span<const Frame> frames, Time duration);

struct Status
{
  std::vector<std::string> positions{}; ///< of connected devices, such as "Vest" and "ForearmL"
  /// Positions that this program plays on now, if the server lists them.
  std::vector<std::string> playing{};
  bool is_asleep = false; ///< bhaptics-linux let the vest go, and wakes it when something plays
};

/// None if it is no status: the server sends others, too.
std::optional<Status> read_status(std::string_view text);

} // namespace tactor::bhaptics
