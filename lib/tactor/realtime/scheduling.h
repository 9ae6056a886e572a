// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string_view>

namespace tactor {

/// How a thread is scheduled, and what granted it.
enum class Scheduling
{
  normal,       ///< not real-time
  direct,       ///< real-time by own permission (RLIMIT_RTPRIO, CAP_SYS_NICE)
  realtime_kit, ///< real-time by RealtimeKit
  portal,       ///< real-time by the desktop portal, as in a sandbox
  given_back,   ///< not real-time any more, as it used too much CPU time
};

/// "normal", "direct", "rtkit", "portal", "given-back".
constexpr std::string_view
to_string(Scheduling scheduling)
{
  switch (scheduling) {
  case Scheduling::direct:
    return "direct";
  case Scheduling::realtime_kit:
    return "rtkit";
  case Scheduling::portal:
    return "portal";
  case Scheduling::given_back:
    return "given-back";
  default:
    return "normal";
  }
}

} // namespace tactor
