// SPDX-License-Identifier: LGPL-2.1-or-later
//
// preview: a film with a track over it.
#include "commands.h"
#include "playback.h"

#include "film/film.h"
#include "film/output.h"
#include "tracks/formats/track_file.h"
#include "translation.h"

#include <vector>

namespace {

constexpr const char *kLookahead
    = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=2000000000";

/// Plays to the end, `path` being what the filesink named "file" writes.
int
write_film(const Pipeline &pipeline, const std::string &path, GstClockTime duration, bool quiet)
{
  const auto [folder, name] = folder_and_name(path);
  Output output(folder, name);
  if (const Owned<GstElement> file = element(pipeline, "file"))
    g_object_set(file.get(), "location", output.part_path().c_str(), nullptr);
  if (!run_to_end(pipeline, duration, quiet))
    return 130;
  output.commit();
  return 0;
}

} // namespace

int
preview(int argc, char **argv)
{
  TextOption output;
  TextOption chair;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("Write or replace a film (.mkv) with the track drawn over the picture, instead of playing "
         "it"),
      "FILM" },
    { "chair", 0, 0, G_OPTION_ARG_STRING, &chair.value,
      N_("Properties of tactorsink, such as 'driver=simulator rate=0' (default: rate=0)"),
      "OPTIONS" },
    {},
  };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM TRACK",
        .summary
        = N_("Plays a film with a track: on the chair and, with a display, on the screen."),
        .least = 2,
        .most = 2 });
  gst_init(nullptr, nullptr);
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const Film film = discover_film(names[0]);
  g_autofree gchar *path = g_filename_from_uri(film.uri.c_str(), nullptr, nullptr);
  if (output.is_set() && path != nullptr)
    refuse_same_file(path, output.text());
  const std::string look = kLookahead;
  const bool has_display = g_getenv("DISPLAY") || g_getenv("WAYLAND_DISPLAY");
  std::string line = film_source(film) + " film. ! " + look
                     + " ! videoconvert ! tactilecombiner name=combiner appsrc name=track ! "
                       "combiner.tactile combiner. ! ";
  if (output.is_set())
    line
        += "tactileoverlay ! videoconvert ! x264enc speed-preset=veryfast ! matroskamux ! filesink "
           "name=file";
  else
    line += "tactileextractor name=split split.src ! " + look
            + " ! tactileoverlay ! videoconvert ! "
            + (has_display ? "autovideosink" : "fakesink sync=true") + " split.tactile ! " + look
            + " ! tactorsink " + chair.text("rate=0");
  const Pipeline pipeline = make_pipeline(line);
  feed_track(element(pipeline, "track").get(), track, film.start.running);
  if (output.is_set())
    return write_film(pipeline, output.text(), film.duration, common.quiet);
  return run_to_end(pipeline, film.duration, common.quiet) ? 0 : 130;
}
