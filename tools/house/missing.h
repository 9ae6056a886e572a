// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film/device_list.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Where missing() looks; tests have other folders.
struct System
{
  std::filesystem::path root = "/";   ///< of /sys, /dev and /proc
  std::filesystem::path modules = ""; ///< of drivers; empty: those of this build
};

/// The drivers whose servers wait for connections on this computer: bhaptics, intiface.
std::vector<std::string> waiting_servers(const System &system = {});

/// The device that answered last, if it is none of these now: its name says so.
std::optional<FoundDevice> absent_device(const std::vector<FoundDevice> &found,
                                         const std::vector<std::string> &servers);

/// What keeps devices of the user from being felt, and the remedy, a line each in the user's
/// language. Opens no device and connects to no server.
std::vector<std::string> missing(const std::vector<FoundDevice> &found, const System &system = {});
