// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtk/gtk.h>

#include <string>

/// Shows the application's window, with a film to play unless that is empty.
void show_window(GtkApplication *application, const std::string &film_uri);
