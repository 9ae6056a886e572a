// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/gst.h>

#include <string>
#include <string_view>

/// Changes saliencytactile as a key says, by its X11 name: Up and Down the sensitivity, Left and
/// Right the density, by a factor of √2. False for another key. Thread-safe.
bool steer(GstElement *analysis, std::string_view key);

/// The present sensitivity and density.
std::string steering_text(GstElement *analysis);
