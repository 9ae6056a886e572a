// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "film.h"
#include "pipeline.h"

#include "fusion/profile.h"
#include "translation.h"

#include <string>

/// The option `--sound`: its help and its profile, nullptr for "off". Throws UsageError.
inline constexpr const char *kSoundHelp
    = N_("Profile of the sound: off (default), film, music, dialogue-heavy or bass-shaker");
const fusion::Profile *sound_profile(const std::string &name);

/// A film's sound in a launch line: a queue `heard`, audioconvert `sound` and, with a profile,
/// soundtactile, whose source pad the line continues.
std::string heard_sound(const std::string &queue, const fusion::Profile *profile);

/// Where the picture's maps meet those of heard_sound(), as " ! ..."; empty without a profile.
std::string joined_sound(const std::string &queue, const fusion::Profile *profile);

/// Elements that they need.
inline constexpr const char *kSoundElements[] = { "soundtactile", "tactilecombiner" };

/// Ends the sound if no decoder was linked to it when `film` has no more pads: others would wait
/// for it. Whether it did. To be called from the handler of no-more-pads.
bool end_missing_sound(GstElement *pipeline);
