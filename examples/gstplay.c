/* SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Plays a film with GstPlay, shown and felt. All that touch takes is the video sink.
 * Usage: gstplay URI [visuotactilesink's properties, as in rows=2 driver=simulator]
 */
#include <gst/gst.h>
#include <gst/play/play.h>

static void
on_end_of_stream(GstPlay *play, GMainLoop *loop)
{
  (void)play;
  g_main_loop_quit(loop);
}

static void
on_warning(GstPlay *play, GError *warning, GstStructure *details)
{
  (void)play;
  (void)details;
  g_printerr("%s\n", warning->message);
}

static void
on_error(GstPlay *play, GError *error, GstStructure *details, GMainLoop *loop)
{
  on_warning(play, error, details);
  g_main_loop_quit(loop);
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
  g_signal_connect(signals, "end-of-stream", G_CALLBACK(on_end_of_stream), loop);
  g_signal_connect(signals, "warning", G_CALLBACK(on_warning), NULL);
  g_signal_connect(signals, "error", G_CALLBACK(on_error), loop);
  gst_play_set_uri(play, argv[1]);
  gst_play_play(play);
  g_main_loop_run(loop);

  gst_play_stop(play);
  g_object_unref(signals);
  g_object_unref(play);
  g_main_loop_unref(loop);
  return 0;
}
