// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile: a window over the commands of this project.
#include "window.h"

#include "film/command_line.h"
#include "translation.h"

#include <glib-unix.h>
#include <gst/gst.h>

#include <csignal>
#include <cstdio>
#include <vector>

namespace {

int
run(int argc, char **argv)
{
  gboolean version = FALSE;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "version", 0, 0, G_OPTION_ARG_NONE, &version, N_("Print the version and exit"), nullptr }, {}
  };
  const std::vector<std::string> films = parse_options(
      argc, argv, entries, common,
      { .arguments = "[FILM]",
        .summary = N_("A window with the devices, the feel test, the settings and the players of "
                      "the chair.\nEach of its buttons runs a command: visuotactile-settings, "
                      "visuotactile-play or\ntactile-track."),
        .least = 0,
        .most = 1,
        .group = gst_init_get_option_group() });
  if (version) {
    std::puts("visuotactile " PACKAGE_VERSION);
    return 0;
  }
  GtkApplication *application
      = gtk_application_new("org.visuotactile.Chair", G_APPLICATION_HANDLES_OPEN);
  g_signal_connect(application, "activate",
                   G_CALLBACK(+[](GtkApplication *self) { show_window(self, ""); }), nullptr);
  g_signal_connect(application, "open",
                   G_CALLBACK(+[](GtkApplication *self, GFile **files, gint count) {
                     g_autofree gchar *uri = count > 0 ? g_file_get_uri(files[0]) : nullptr;
                     show_window(self, uri ? uri : "");
                   }),
                   nullptr);
  for (const int number : { SIGTERM, SIGINT, SIGHUP })
    g_unix_signal_add(
        number,
        +[](gpointer own) -> gboolean { // with the window, what it runs ends
          if (GtkWindow *window = gtk_application_get_active_window(GTK_APPLICATION(own)))
            gtk_window_destroy(window);
          return G_SOURCE_CONTINUE;
        },
        application);
  // A name may begin with "-".
  g_autoptr(GFile) film
      = films.empty() ? nullptr : g_file_new_for_commandline_arg(films.front().c_str());
  g_autofree gchar *uri = film ? g_file_get_uri(film) : nullptr;
  char *arguments[] = { argv[0], uri, nullptr };
  const int status = g_application_run(G_APPLICATION(application), uri ? 2 : 1, arguments);
  g_object_unref(application);
  return status;
}

} // namespace

int
main(int argc, char **argv)
{
  try {
    return run(argc, argv);
  } catch (const Help &help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const UsageError &error) {
    print_error("visuotactile", in_text("{}; see --help", error.what()));
    return 2;
  }
}
