// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/sound_maps.h"

#include <gst/gst.h>

#include <memory>

/// The maps of the sound in the element's pipeline, which the topmost bin keeps as long as it
/// lives, and which the first caller makes. Any thread, with any locks held but object locks: it
/// does not wait. It posts no message: players that count messages see none.
std::shared_ptr<fusion::SoundMaps> sound_maps_of(GstElement *element);
