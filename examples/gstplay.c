/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Plays a film with GstPlay, on screen and on the chair. Only the video sink is special.
 * Usage: gstplay URI [visuotactilesink's properties, such as rows=2 driver=simulator]
 */
#include <glib-unix.h>
#include <gst/gst.h>
#include <gst/play/play.h>

/* After the end of the film, an error and gst_play_stop() alike. From now on GstPlay has no
 * reference to itself, and the last unref waits until the pipeline is down. A program that exits
 * earlier would take it from threads that still use it. */
static void
on_state_changed(GstPlay *play, GstPlayState state, GMainLoop *loop)
{
  (void)play;
  if (state == GST_PLAY_STATE_STOPPED)
    g_main_loop_quit(loop);
}

static void
on_message(GstPlay *play, GError *message, GstStructure *details)
{
  (void)play;
  (void)details;
  g_printerr("%s\n", message->message);
}

/* A killed process leaves the motors running until the firmware's watchdog stops them, if it has
 * one. */
static gboolean
on_signal(gpointer play)
{
  gst_play_stop(play);
  return G_SOURCE_CONTINUE;
}

int
main(int argc, char **argv)
{
  gst_init(&argc, &argv);
  if (argc < 2) {
    g_printerr("usage: %s URI [property=value ...]\n", argv[0]);
    return 2;
  }

  gchar *properties = g_strjoinv(" ", argv + 2);
  gchar *description = g_strconcat("visuotactilesink ", properties, NULL);
  GError *error = NULL;
  GstElement *sink = gst_parse_launch(description, &error);
  g_free(description);
  g_free(properties);
  if (error) {
    g_printerr("%s\n", error->message);
    return 1;
  }

  GstPlay *play = gst_play_new(gst_play_video_overlay_video_renderer_new_with_sink(NULL, sink));
  GstPlaySignalAdapter *signals = gst_play_signal_adapter_new(play);
  GMainLoop *loop = g_main_loop_new(NULL, FALSE);
  g_signal_connect(signals, "state-changed", G_CALLBACK(on_state_changed), loop);
  g_signal_connect(signals, "warning", G_CALLBACK(on_message), NULL);
  g_signal_connect(signals, "error", G_CALLBACK(on_message), NULL);
  g_unix_signal_add(SIGINT, on_signal, play);
  g_unix_signal_add(SIGTERM, on_signal, play);
  gst_play_set_uri(play, argv[1]);
  gst_play_play(play);
  g_main_loop_run(loop);

  g_object_unref(signals);
  g_object_unref(play);
  g_main_loop_unref(loop);
  return 0;
}
