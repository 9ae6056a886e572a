// SPDX-License-Identifier: LGPL-2.1-or-later
//
// preview, mux: films with a track.
#include "../visuotactile-play/film.h"
#include "../visuotactile-play/output.h"
#include "commands.h"
#include "pipeline.h"
#include "subtitles.h"
#include "tracks/formats/film_file.h"
#include "tracks/formats/track_file.h"

#include <atomic>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <mutex>
#include <string_view>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace {

constexpr const char *kLookahead
    = "queue max-size-bytes=0 max-size-buffers=0 max-size-time=2000000000";

/// Plays to the end with the file as location of the element named so; keeps it if `is_film` says
/// so then of what was written.
int
write_film(
    const Owned<GstElement> &pipeline, const std::string &path, GstClockTime duration, bool quiet,
    const std::function<bool(const std::string &)> &is_film
    = [](const std::string &) { return true; })
{
  const auto [folder, name] = folder_and_name(path);
  Output output(folder, name);
  if (const Owned<GstElement> file = element(pipeline, "file"))
    g_object_set(file.get(), "location", output.part_path().c_str(), nullptr);
  if (!run_to_end(pipeline, duration, quiet))
    return 130;
  if (!is_film(output.part_path().string()))
    throw std::runtime_error("'" + path + "' can hold no stream of the film");
  output.commit();
  return 0;
}

/// No player shall take the track of the film, which was written, by itself: muxers of GStreamer
/// 1.22 say that each track is meant to be taken. Throws std::runtime_error.
void
leave_track_to_choice(const std::string &path)
{
  const auto fail = [&] {
    throw std::runtime_error("cannot mark the track in '" + path + "': " + g_strerror(errno));
  };
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  struct stat status = {};
  if (file < 0 || fstat(file, &status) != 0)
    fail();
  const auto size = static_cast<std::size_t>(status.st_size);
  void *const bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (bytes == MAP_FAILED)
    fail();
  const std::size_t marked
      = tactile::disable_by_default({ static_cast<std::uint8_t *>(bytes), size });
  munmap(bytes, size);
  close(file);
  if (marked == 0)
    std::fputs("tactile-track: warning: players may take the track by themselves\n", stderr);
}

/// A film is not written over itself. Throws UsageError.
void
refuse_same_file(const std::string &film, const std::string &output)
{
  std::error_code none;
  if (std::filesystem::equivalent(film, output, none))
    throw UsageError("'" + output + "' is the film itself; give another name");
}

/// The parser that brings a stream into the form that a muxer wants.
std::string
parser_of(const GstStructure *structure)
{
  gint version = 0;
  gst_structure_get_int(structure, "mpegversion", &version);
  const std::string name = gst_structure_get_name(structure);
  std::string parser = name == "video/x-h264"                 ? "h264parse"
                       : name == "video/x-h265"               ? "h265parse"
                       : name == "audio/mpeg" && version == 1 ? "mpegaudioparse"
                       : name == "audio/mpeg"                 ? "aacparse"
                                                              : "";
  GstElementFactory *factory = parser.empty() ? nullptr : gst_element_factory_find(parser.c_str());
  if (!factory)
    return "identity";
  gst_object_unref(factory);
  return parser;
}

struct Muxing
{
  GstElement *pipeline;
  GstElement *muxer;
  GstElement *source; ///< of the track
  GstElement *last;   ///< of the track's branch
  const tactile::Track &track;
  CueForm form;
  const std::vector<Subtitles> &subtitles; ///< the film's own
  bool first;                              ///< the track comes before them
  std::atomic<int> taken{ 0 };             ///< streams
  std::once_flag begun{};
};

void
add_track(Muxing &muxing)
{
  if (!gst_element_link_pads(muxing.last, "src", muxing.muxer,
                             muxing.form == CueForm::klv ? "sink_%d" : "subtitle_%u"))
    GST_ELEMENT_ERROR(muxing.muxer, STREAM, FAILED, ("The file cannot hold a track."), (nullptr));
  const Owned<GstPad> pad(gst_element_get_static_pad(muxing.last, "src"));
  Preface preface(pad.get());
  feed_track(muxing.source, muxing.track, muxing.form);
  preface.wait();
}

void
leave_out(const GstCaps *caps)
{
  std::fprintf(stderr, "tactile-track: warning: left out: %s\n",
               gst_structure_get_name(gst_caps_get_structure(caps, 0)));
}

/// The first data of the film: pictures and sounds are linked now. Subtitles and the track come
/// after them, for a transport stream takes its clock from the first; then the muxer may begin.
GstPadProbeReturn
begin_track(GstPad *, GstPadProbeInfo *, gpointer data)
{
  auto *muxing = static_cast<Muxing *>(data);
  std::call_once(muxing->begun, [&] {
    if (muxing->first)
      add_track(*muxing);
    for (const Subtitles &subtitles : muxing->subtitles)
      if (muxing->form != CueForm::text
          || !add_subtitles(muxing->pipeline, muxing->muxer, subtitles))
        leave_out(subtitles.caps.get());
    if (!muxing->first)
      add_track(*muxing);
  });
  return GST_PAD_PROBE_REMOVE;
}

/// Takes a picture or sound of the film over into the muxer as it is; subtitles come otherwise.
/// Those that it cannot hold are left out, with a word about it.
void
take_stream(GstElement *, GstPad *pad, gpointer data)
{
  auto *muxing = static_cast<Muxing *>(data);
  GstCaps *caps = gst_pad_get_current_caps(pad);
  if (!caps)
    caps = gst_pad_query_caps(pad, nullptr);
  const std::string_view kind = gst_structure_get_name(gst_caps_get_structure(caps, 0));
  const bool is_known = is_subtitles(gst_caps_get_structure(caps, 0));
  const std::string line = parser_of(gst_caps_get_structure(caps, 0)) + " ! " + kLookahead;
  Owned<GstElement> branch(gst_parse_bin_from_description(line.c_str(), TRUE, nullptr));
  GstElement *bin = branch.get();
  gst_object_ref_sink(bin);
  gst_bin_add(GST_BIN(muxing->pipeline), bin);
  const Owned<GstPad> sink(gst_element_get_static_pad(bin, "sink"));
  // Motion JPEG is image/jpeg.
  if (!(kind.starts_with("video/") || kind.starts_with("image/") || kind.starts_with("audio/"))
      || GST_PAD_LINK_FAILED(gst_pad_link(pad, sink.get()))
      || !gst_element_link(bin, muxing->muxer)) {
    if (!is_known)
      leave_out(caps);
    gst_element_set_state(bin, GST_STATE_NULL);
    gst_bin_remove(GST_BIN(muxing->pipeline), bin);
    const Owned<GstElement> nothing(gst_element_factory_make("fakesink", nullptr));
    g_object_set(nothing.get(), "async", FALSE, "sync", FALSE, nullptr);
    gst_object_ref_sink(nothing.get());
    gst_bin_add(GST_BIN(muxing->pipeline), nothing.get());
    const Owned<GstPad> drain(gst_element_get_static_pad(nothing.get(), "sink"));
    gst_pad_link(pad, drain.get());
    gst_element_sync_state_with_parent(nothing.get());
  } else {
    gst_element_sync_state_with_parent(bin);
    muxing->taken++;
  }
  gst_caps_unref(caps);
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, begin_track, muxing, nullptr);
}

} // namespace

int
preview(int argc, char **argv)
{
  TextOption output;
  TextOption chair;
  Manner manner;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      "Record the film with the track over it (.mkv) instead of playing it", "FILM" },
    { "chair", 0, 0, G_OPTION_ARG_STRING, &chair.value,
      "Properties of tactorsink, such as 'driver=simulator rate=0' (default: rate=0)", "OPTIONS" },
    {},
  };
  const std::vector<std::string> names
      = parse_options(argc, argv, entries, manner,
                      { .arguments = "FILM TRACK",
                        .summary = "Shows what a track does with a film: on the screen, where "
                                   "there is one, and the chair, or recorded.",
                        .least = 2,
                        .most = 2 });
  gst_init(nullptr, nullptr);
  if (output.given())
    refuse_same_file(names[0], output.text());
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const Film film = discover_film(names[0]);
  const std::string look = kLookahead;
  const bool has_display = g_getenv("DISPLAY") || g_getenv("WAYLAND_DISPLAY");
  std::string line = film_source(film) + " film. ! " + look
                     + " ! videoconvert ! tactilecombiner name=combiner appsrc name=track ! "
                       "combiner.tactile combiner. ! ";
  if (output.given())
    line
        += "tactileoverlay ! videoconvert ! x264enc speed-preset=veryfast ! matroskamux ! filesink "
           "name=file";
  else
    line += "tactileextractor name=split split.src ! " + look
            + " ! tactileoverlay ! videoconvert ! "
            + (has_display ? "autovideosink" : "fakesink sync=true") + " split.tactile ! " + look
            + " ! tactorsink " + chair.text("rate=0");
  const Owned<GstElement> pipeline = make_pipeline(line);
  feed_track(element(pipeline, "track").get(), track, CueForm::map);
  if (output.given())
    return write_film(pipeline, output.text(), film.duration, manner.quiet);
  return run_to_end(pipeline, film.duration, manner.quiet) ? 0 : 130;
}

int
mux(int argc, char **argv)
{
  TextOption output;
  gboolean first = FALSE;
  Manner manner;
  const GOptionEntry entries[] = { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
                                     "The film to write: .mkv, .mp4 or .ts", "FILM" },
                                   { "first", 0, 0, G_OPTION_ARG_NONE, &first,
                                     "The track before the film's own subtitles, for players that "
                                     "take the first (default: after them)",
                                     nullptr },
                                   {} };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, manner,
      { .arguments = "FILM TRACK -o OUT",
        .summary = "Puts a track into a film's file beside its other streams, which stay as they "
                   "are:\nin .mkv and .mp4 as text cues (subtitles 'Tactile'), in .ts as KLV.",
        .least = 2,
        .most = 2 });
  if (!output.given())
    throw UsageError("expected -o OUT");
  const std::string out = output.text();
  const bool is_ts = out.ends_with(".ts");
  const char *muxer = out.ends_with(".mkv")   ? "matroskamux"
                      : out.ends_with(".mp4") ? "mp4mux"
                      : is_ts                 ? "mpegtsmux"
                                              : nullptr;
  if (!muxer)
    throw UsageError("expected a name that ends in .mkv, .mp4 or .ts, got '" + out + "'");
  gst_init(nullptr, nullptr);
  refuse_same_file(names[0], out);
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const Film film = discover_film(names[0]);
  g_autofree gchar *path = g_filename_from_uri(film.uri.c_str(), nullptr, nullptr);
  if (!path)
    throw std::runtime_error("'" + names[0] + "' is no file here");

  std::vector<Subtitles> subtitles;
  if (!read_subtitles(path, film.duration, manner.quiet, subtitles))
    return 130;

  // The track by its tags: no language, and a name by which players tell it from subtitles.
  const Owned<GstElement> pipeline = make_pipeline(
      std::string("filesrc location=") + launch_value(path) + " ! parsebin name=film  " + muxer
      + " name=muxer ! filesink name=file  appsrc name=track ! "
      + (is_ts ? "" : "taginject tags=\"title=Tactile,language-code=zxx\" ! ") + kLookahead
      + " name=last");
  const Owned<GstElement> mux = element(pipeline, "muxer");
  const Owned<GstElement> source = element(pipeline, "track");
  g_object_set(source.get(), "format", GST_FORMAT_TIME, nullptr);
  const Owned<GstElement> last = element(pipeline, "last");
  Muxing muxing{ .pipeline = pipeline.get(),
                 .muxer = mux.get(),
                 .source = source.get(),
                 .last = last.get(),
                 .track = track,
                 .form = is_ts ? CueForm::klv : CueForm::text,
                 .subtitles = subtitles,
                 .first = first != FALSE };
  const Owned<GstElement> streams = element(pipeline, "film");
  g_signal_connect(streams.get(), "autoplug-continue",
                   G_CALLBACK(+[](GstElement *, GstPad *, GstCaps *caps, gpointer) -> gboolean {
                     return !is_subtitles(gst_caps_get_structure(caps, 0));
                   }),
                   nullptr);
  g_signal_connect(streams.get(), "pad-added", G_CALLBACK(take_stream), &muxing);
  return write_film(pipeline, out, film.duration, manner.quiet, [&](const std::string &written) {
    if (muxing.taken > 0 && !is_ts)
      leave_track_to_choice(written);
    return muxing.taken > 0;
  });
}
