// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>
#include <vector>

/// A way in which films of other programs are felt. The user switches it on and off.
struct Switch
{
  std::string name;     ///< of `visuotactile-settings on NAME`
  std::string title;    ///< for people
  bool is_there = true; ///< the program is installed
  bool is_on = false;
};

/// All known ones: GStreamer's players, mpv and Kodi by their scripts, and follow, the service that
/// follows any player. Starts no program.
std::vector<Switch> switches();

/// Switches mpv, kodi or follow; false for another name, whose switch is in the settings. Throws
/// std::runtime_error: a file of the user is in the way, or the session has no systemd.
bool switch_outside_settings(const std::string &name, bool on);

/// Follow's service, if it runs, plays on the device of the settings.
void restart_follow();
