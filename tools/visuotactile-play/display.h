// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

/// The element that can show a picture here; empty: none.
std::string video_sink();
