/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * To be preloaded: no time in whole seconds ever passes, so that a program that waits for one
 * hangs. */
#include <glib.h>

guint
g_timeout_add_seconds(guint interval, GSourceFunc function, gpointer data)
{
  (void)interval;
  return g_timeout_add_seconds_full(G_PRIORITY_DEFAULT, G_MAXINT / 1000, function, data, NULL);
}
