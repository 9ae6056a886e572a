// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-play: plays a film on screen (or records it) and on the chair, and reports how it went.
#include "film.h"
#include "output.h"
#include "player.h"
#include "strip.h"

#include <gst/gst.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <unistd.h>

namespace {

constexpr int kStripFrames = 6;

struct Options
{
  gchar *output = nullptr;
  gchar *profile = nullptr;
  gchar *compensation = nullptr;
  gint rows = 3;
  gint columns = 3;
  gdouble rate = 5;
  gboolean no_window = FALSE;
  gboolean print_pipeline = FALSE;
  gboolean quiet = FALSE;
  gboolean version = FALSE;
  gchar **films = nullptr;

  ~Options()
  {
    g_free(output);
    g_free(profile);
    g_free(compensation);
    g_strfreev(films);
  }
};

/// Reads the command line. False if there is nothing more to do, with the exit status.
bool
parse_options(int argc, char **argv, Options &options, int &status)
{
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &options.output, "Folder for what is written (default: the working directory)", "DIR" },
    { "no-window", 'n', 0, G_OPTION_ARG_NONE, &options.no_window, "Record visuotactile.mkv even where there is a display", nullptr },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &options.profile, "How saliency is computed: tuned (default) or paper", "NAME" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &options.rows, "Rows of tactors, 1 to 64 (default: 3)", "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &options.columns, "Columns of tactors, 1 to 64 (default: 3)", "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &options.rate, "How often tactors may change, in Hz; 0: with every frame (default: 5)", "HZ" },
    { "compensation", 0, 0, G_OPTION_ARG_STRING, &options.compensation, "Of the motors' rise time: exact (default), frame-block or none", "NAME" },
    { "print-pipeline", 0, 0, G_OPTION_ARG_NONE, &options.print_pipeline, "Print the gst-launch-1.0 line and exit", nullptr },
    { "quiet", 'q', 0, G_OPTION_ARG_NONE, &options.quiet, "No progress, only the report", nullptr },
    { "version", 0, 0, G_OPTION_ARG_NONE, &options.version, "Print the version and exit", nullptr },
    { G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &options.films, nullptr, "[FILM]" },
    {},
  };
  g_autoptr(GOptionContext) context = g_option_context_new("- play a film on screen and on a (simulated) tactile chair");
  g_option_context_set_summary(
      context, "FILM is a file or a URI; without one a synthetic film is played. With a display the film is shown with its tactile\n"
               "overlay; without one it is played in real time all the same and recorded as visuotactile.mkv. The commands to the\n"
               "chair are written to commands.csv, a few frames with their maps to strip.png. Ctrl-C ends the film in order.");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  status = 2;
  if (!g_option_context_parse(context, &argc, &argv, &error)) {
    std::fprintf(stderr, "visuotactile-play: %s; see --help\n", error->message);
    return false;
  }
  if (options.version) {
    std::puts("visuotactile-play " PACKAGE_VERSION);
    status = 0;
    return false;
  }
  const char *wrong = nullptr;
  if (options.films && g_strv_length(options.films) > 1)
    wrong = "expected one film at the most";
  else if (options.rows < 1 || options.rows > 64 || options.columns < 1 || options.columns > 64)
    wrong = "--rows and --columns are whole numbers from 1 to 64";
  else if (!(options.rate >= 0 && options.rate <= 1000))
    wrong = "--rate is a number of Hz from 0 to 1000";
  else if (options.profile && !g_str_equal(options.profile, "tuned") && !g_str_equal(options.profile, "paper"))
    wrong = "--profile is tuned or paper";
  else if (options.compensation && !g_str_equal(options.compensation, "exact")
           && !g_str_equal(options.compensation, "frame-block") && !g_str_equal(options.compensation, "none"))
    wrong = "--compensation is exact, frame-block or none";
  if (wrong) {
    std::fprintf(stderr, "visuotactile-play: %s; see --help\n", wrong);
    return false;
  }
  return true;
}

double
milliseconds(const GstStructure *stats, const char *field)
{
  guint64 positive = 0;
  gint64 value = 0;
  if (stats && gst_structure_get_uint64(stats, field, &positive))
    return static_cast<double>(positive) / 1e6;
  if (stats)
    gst_structure_get_int64(stats, field, &value);
  return static_cast<double>(value) / 1e6;
}

unsigned long long
number(const GstStructure *stats, const char *field)
{
  guint64 value = 0;
  if (stats)
    gst_structure_get_uint64(stats, field, &value);
  return value;
}

void
print_report(const Film &film, const PlayReport &report)
{
  const double seconds = static_cast<double>(report.position) / GST_SECOND;
  std::printf("\nFilm           %s\n", film.title.c_str());
  std::printf("Picture        %d x %d", film.width, film.height);
  if (film.fps > 0)
    std::printf(", %.5g frames/s", film.fps);
  std::printf("%s\n", film.has_sound ? ", with sound" : ", no sound");
  std::printf("Played         %.1f s", seconds);
  if (GST_CLOCK_TIME_IS_VALID(film.duration))
    std::printf(" of %.1f s", static_cast<double>(film.duration) / GST_SECOND);
  if (report.stopped)
    std::printf(" (stopped)");
  std::printf("\n");
  if (!report.ended_early.empty())
    std::printf("Film broken    it ends here: %s\n", report.ended_early.c_str());
  else if (!report.stopped && GST_CLOCK_TIME_IS_VALID(film.duration)
           && seconds < 0.98 * static_cast<double>(film.duration) / GST_SECOND - 0.5)
    std::printf("Film broken    it ends here, before the length that its header states: is the file truncated?\n");
  std::printf("Frames         %llu, of which %llu are felt\n", number(report.analysis, "frames"), number(report.analysis, "active"));
  std::printf("Analysis       %.2f ms per frame (longest %.2f ms)\n", milliseconds(report.analysis, "analysis-mean"),
              milliseconds(report.analysis, "analysis-max"));
  std::printf("Commands       %llu issued, %llu late, %llu coalesced\n", number(report.chair, "issued"),
              number(report.chair, "late"), number(report.chair, "coalesced"));
  std::printf("Schedule error %.2f ms p50, %.2f ms p99, %.2f ms max\n", milliseconds(report.chair, "error-p50"),
              milliseconds(report.chair, "error-p99"), milliseconds(report.chair, "error-max"));
}

int
run(const Options &options)
{
  for (const char *name : { "saliencytactile", "tactileextractor", "tactileoverlay", "tactorsink", "tactiletestsrc" }) {
    GstElementFactory *factory = gst_element_factory_find(name);
    if (!factory) {
      std::fprintf(stderr,
                   "visuotactile-play: GStreamer has no element '%s'; install the project (meson install) or start with pipelines/play.sh\n", name);
      return 1;
    }
    gst_object_unref(factory);
  }

  const Film film = options.films && options.films[0] ? discover_film(options.films[0]) : synthetic_film();

  PlaySettings settings;
  settings.window = !options.no_window && have_display();
  settings.quiet = options.quiet;
  settings.progress_in_place = isatty(STDERR_FILENO);
  settings.analysis_options = std::string("profile=") + (options.profile ? options.profile : "tuned")
                              + " rows=" + std::to_string(options.rows) + " columns=" + std::to_string(options.columns);
  char rate[G_ASCII_DTOSTR_BUF_SIZE];
  settings.chair_options = std::string("rate=") + g_ascii_dtostr(rate, sizeof rate, options.rate)
                           + " compensation=" + (options.compensation ? options.compensation : "exact");

  const std::filesystem::path directory = options.output ? options.output : ".";
  if (options.print_pipeline) {
    settings.recording = directory / "visuotactile.mkv";
    settings.commands = directory / "commands.csv";
    std::printf("gst-launch-1.0 -e %s\n", launch_line(film, settings).c_str());
    return 0;
  }

  prepare_directory(directory);
  Output recording(directory, "visuotactile.mkv");
  Output commands(directory, "commands.csv");
  Output picture(directory, "strip.png");
  settings.recording = recording.part_path();
  settings.commands = commands.part_path();

  if (!options.quiet)
    std::fprintf(stderr, "%s '%s'; Ctrl-C ends it\n", settings.window ? "Playing" : "Recording, in real time,", film.title.c_str());
  Strip strip(film.duration, kStripFrames);
  const PlayReport report = play(film, settings, strip);
  if (!report.failure.empty()) {
    std::fprintf(stderr, "visuotactile-play: %s\n", report.failure.c_str());
    return 1;
  }
  if (!report.played && !report.stopped) {
    std::fprintf(stderr, "visuotactile-play: '%s' has no frame that can be decoded\n", film.title.c_str());
    return 1;
  }

  print_report(film, report);
  strip.write(picture.part_path());
  std::string written;
  for (Output *output : { &recording, &commands, &picture })
    if (output->commit())
      written += (written.empty() ? "" : ", ") + output->final_path().lexically_normal().string();
  std::printf("Written        %s\n", written.empty() ? "nothing" : written.c_str());
  return 0;
}

} // namespace

int
main(int argc, char **argv)
{
  Options options;
  int status = 0;
  if (!parse_options(argc, argv, options, status))
    return status;
  try {
    return run(options);
  } catch (const std::exception &e) {
    std::fprintf(stderr, "visuotactile-play: %s\n", e.what());
    return 1;
  }
}
