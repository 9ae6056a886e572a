// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "fusion/sound_maps.h"

#include <gst/gst.h>

#include <memory>

/// The maps of the sound in the element's pipeline. They are in a GstContext, which the pipeline
/// keeps until NULL: the first element that asks makes it (NEED_CONTEXT, HAVE_CONTEXT). An
/// application can set one context on several pipelines. On READY to PAUSED; elements of one
/// pipeline not on several threads at once.
std::shared_ptr<fusion::SoundMaps> sound_maps_of(GstElement *element);
