// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/// Whether a picture can be shown here.
bool have_display();
