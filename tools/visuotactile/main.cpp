// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile: a window over the commands of this project.
#include "window.h"

#include "house/translation.h"

#include <gst/gst.h>

#include <cstdio>

int
main(int argc, char **argv)
{
  use_translations();
  textdomain(PACKAGE);
  gst_init(&argc, &argv);
  GtkApplication *application
      = gtk_application_new("org.visuotactile.Chair", G_APPLICATION_HANDLES_OPEN);
  g_application_set_option_context_parameter_string(G_APPLICATION(application), _("[FILM]"));
  g_application_set_option_context_summary(
      G_APPLICATION(application),
      _("A window with the devices, the feel test, the settings and the players of the chair.\n"
        "Each of its buttons runs a command: visuotactile-settings, visuotactile-play or\n"
        "tactile-track."));
  g_application_add_main_option(G_APPLICATION(application), "version", 0, G_OPTION_FLAG_NONE,
                                G_OPTION_ARG_NONE, _("Print the version and exit"), nullptr);
  g_signal_connect(application, "handle-local-options",
                   G_CALLBACK(+[](GApplication *, GVariantDict *options) {
                     if (!g_variant_dict_contains(options, "version"))
                       return -1;
                     std::puts("visuotactile " PACKAGE_VERSION);
                     return 0;
                   }),
                   nullptr);
  g_signal_connect(application, "activate",
                   G_CALLBACK(+[](GtkApplication *self) { show_window(self, ""); }), nullptr);
  g_signal_connect(application, "open",
                   G_CALLBACK(+[](GtkApplication *self, GFile **files, gint count) {
                     g_autofree gchar *uri = count > 0 ? g_file_get_uri(files[0]) : nullptr;
                     show_window(self, uri ? uri : "");
                   }),
                   nullptr);
  const int status = g_application_run(G_APPLICATION(application), argc, argv);
  g_object_unref(application);
  return status;
}
