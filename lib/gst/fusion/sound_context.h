// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/sound_maps.h"

#include <gst/gst.h>

#include <memory>

/// The maps of the sound in the element's pipeline. They are in a GstContext of the topmost bin,
/// which the first element that asks makes, and which is forgotten in NULL. No message tells of it:
/// players that count messages see none. An application can give one pipeline's context to another.
/// On READY to PAUSED.
std::shared_ptr<fusion::SoundMaps> sound_maps_of(GstElement *element);
