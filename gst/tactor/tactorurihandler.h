// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <glib-object.h>

/// Fills in tactorsink's GstURIHandlerInterface: `tactor://SERIAL` is the board with that serial
/// number or bus path, `tactor://` the first that answers. It sets the properties `driver` and
/// `device`.
void tactor_uri_handler_init(gpointer interface, gpointer data);
