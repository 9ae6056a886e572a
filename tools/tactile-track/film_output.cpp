// SPDX-License-Identifier: LGPL-2.1-or-later
//
// preview, mux: films with a track.
#include "commands.h"
#include "playback.h"
#include "subtitles.h"

#include "film/film.h"
#include "film/output.h"
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

/// Plays to the end, `path` being what the filesink named "file" writes. The file is kept if
/// `is_film` accepts it.
int
write_film(
    const Pipeline &pipeline, const std::string &path, GstClockTime duration, bool quiet,
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
    throw std::runtime_error(
        "'" + path + "' would have no stream of the film: its container takes none of them");
  output.commit();
  return 0;
}

/// Clears the default flag of the track in a film: GStreamer 1.22's muxers set it for each stream,
/// and players would show the track as subtitles. Throws std::runtime_error.
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
    std::fputs("tactile-track: warning: players may select the track by default\n", stderr);
}

/// Throws UsageError if the output would overwrite the film.
void
refuse_same_file(const std::string &film, const std::string &output)
{
  std::error_code none;
  if (std::filesystem::equivalent(film, output, none))
    throw UsageError("'" + output + "' is the film itself; give another name");
}

/// The parser that converts a stream to the format of a muxer, or identity.
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
    GST_ELEMENT_ERROR(muxing.muxer, STREAM, FAILED, ("The container has no stream for a track."),
                      (nullptr));
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

/// At the film's first data all video and audio is linked. Subtitles and the track follow, because
/// mpegtsmux takes its clock from the first stream.
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

/// Links a video or audio stream of the film to the muxer, without decoding. Streams that the muxer
/// does not take are drained, with a warning; subtitles are add_subtitles()'s.
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
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      "Record the film with the track drawn over it (.mkv) instead of playing it", "FILM" },
    { "chair", 0, 0, G_OPTION_ARG_STRING, &chair.value,
      "Properties of tactorsink, such as 'driver=simulator rate=0' (default: rate=0)", "OPTIONS" },
    {},
  };
  const std::vector<std::string> names
      = parse_options(argc, argv, entries, common,
                      { .arguments = "FILM TRACK",
                        .summary = "Plays a film with a track on the chair and, with a display, on "
                                   "screen, or records it.",
                        .least = 2,
                        .most = 2 });
  gst_init(nullptr, nullptr);
  if (output.is_set())
    refuse_same_file(names[0], output.text());
  const tactile::Track track = or_throw(tactile::read_track_file(names[1]));
  const Film film = discover_film(names[0]);
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
  feed_track(element(pipeline, "track").get(), track, CueForm::map, film.start.running);
  if (output.is_set())
    return write_film(pipeline, output.text(), film.duration, common.quiet);
  return run_to_end(pipeline, film.duration, common.quiet) ? 0 : 130;
}

int
mux(int argc, char **argv)
{
  TextOption output;
  gboolean first = FALSE;
  CommonOptions common;
  const GOptionEntry entries[] = { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
                                     "The film to write: .mkv, .mp4 or .ts", "FILM" },
                                   { "first", 0, 0, G_OPTION_ARG_NONE, &first,
                                     "Put the track before the film's own subtitles, for players "
                                     "that use the first (default: after)",
                                     nullptr },
                                   {} };
  const std::vector<std::string> names = parse_options(
      argc, argv, entries, common,
      { .arguments = "FILM TRACK -o OUT",
        .summary
        = "Adds a track to a film's file, whose other streams are copied: in .mkv and .mp4 as "
          "text\ncues (subtitles named 'Tactile'), in .ts as KLV. Players do not select the "
          "track by default.",
        .least = 2,
        .most = 2 });
  if (!output.is_set())
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
    throw std::runtime_error("'" + names[0] + "' is no local file");

  std::vector<Subtitles> subtitles;
  if (!read_subtitles(path, film.duration, common.quiet, subtitles))
    return 130;

  // Tags: no linguistic content (zxx), and a name by which users tell it from subtitles.
  const Pipeline pipeline = make_pipeline(
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
  return write_film(pipeline, out, film.duration, common.quiet, [&](const std::string &written) {
    if (muxing.taken > 0 && !is_ts)
      leave_track_to_choice(written);
    return muxing.taken > 0;
  });
}
