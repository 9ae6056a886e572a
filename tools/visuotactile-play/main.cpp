// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-play: plays a film on screen (or records it) and on the chair, and reports how it
// went.
#include "../manner.h"
#include "film.h"
#include "output.h"
#include "player.h"
#include "strip.h"

#include "tactor/drivers/board_choice.h"
#include "tactor/drivers/release_boards.h"

#include <gst/gst.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <unistd.h>

namespace {

constexpr int kStripFrames = 6;
constexpr const char *kRecording = "visuotactile.mkv";

/// Every error is one line, whatever the names in it.
void
complain(std::string message)
{
  std::ranges::replace_if(
      message, [](char c) { return g_ascii_iscntrl(c); }, ' ');
  std::fprintf(stderr, "visuotactile-play: %s\n", message.c_str());
}

bool
is_same_file(const std::string &uri, const std::filesystem::path &path)
{
  g_autofree gchar *film = g_filename_from_uri(uri.c_str(), nullptr, nullptr);
  std::error_code error;
  return film && std::filesystem::equivalent(film, path, error);
}

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
  Manner manner;
  gboolean release_boards = FALSE;
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
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &options.output,
      "Folder for what is written (default: the working directory)", "DIR" },
    { "no-window", 'n', 0, G_OPTION_ARG_NONE, &options.no_window,
      "Record visuotactile.mkv even where there is a display", nullptr },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &options.profile,
      "How saliency is computed: tuned (default) or paper", "NAME" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &options.rows, "Rows of tactors, 1 to 64 (default: 3)",
      "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &options.columns,
      "Columns of tactors, 1 to 64 (default: 3)", "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &options.rate,
      "How often tactors may change, in Hz; 0: with every frame (default: 5)", "HZ" },
    { "compensation", 0, 0, G_OPTION_ARG_STRING, &options.compensation,
      "Of the motors' rise time: exact (default), frame-block or none", "NAME" },
    { "print-pipeline", 0, 0, G_OPTION_ARG_NONE, &options.print_pipeline,
      "Print the gst-launch-1.0 line and exit", nullptr },
    { "release-boards", 0, 0, G_OPTION_ARG_NONE, &options.release_boards,
      "Stop the motors of boards that a killed player left, give the boards back to the system, "
      "and exit",
      nullptr },
    { "version", 0, 0, G_OPTION_ARG_NONE, &options.version, "Print the version and exit", nullptr },
    { G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &options.films, nullptr, "[FILM]" },
    {},
  };
  g_autoptr(GOptionContext) context
      = g_option_context_new("- play a film on screen and on a (simulated) tactile chair");
  g_option_context_set_summary(context,
                               "FILM is a file or a URI; without one a synthetic film is played. "
                               "With a display the film is shown with its tactile\n"
                               "overlay; without one it is played in real time all the same and "
                               "recorded as visuotactile.mkv. The commands to the\n"
                               "chair are written to commands.csv, a few frames with their maps to "
                               "strip.png. Ctrl-C ends the film in order.");
  const auto common = options.manner.entries(Manner::kWritesAnyway, "No progress, only the report");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_main_entries(context, common.data(), nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  status = 2;
  if (!g_option_context_parse(context, &argc, &argv, &error)) {
    complain(std::string(error->message) + "; see --help");
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
  else if (options.profile && !g_str_equal(options.profile, "tuned")
           && !g_str_equal(options.profile, "paper"))
    wrong = "--profile is tuned or paper";
  else if (options.compensation && !g_str_equal(options.compensation, "exact")
           && !g_str_equal(options.compensation, "frame-block")
           && !g_str_equal(options.compensation, "none"))
    wrong = "--compensation is exact, frame-block or none";
  if (wrong) {
    complain(std::string(wrong) + "; see --help");
    return false;
  }
  return true;
}

/// A line for each board that was left. The exit status.
int
release_boards()
{
  const auto released = tactor::release_boards();
  if (!released)
    throw std::runtime_error(released.error().text);
  if (released->empty())
    std::puts("No board was left by a player that was killed.");
  bool all_stopped = true;
  for (const auto &[device, refusal] : *released) {
    if (refusal)
      complain(tactor::describe(device) + ": its motors could not be stopped: " + refusal->text);
    else
      std::printf("%s: motors stopped, given back\n", tactor::describe(device).c_str());
    all_stopped = all_stopped && !refusal;
  }
  return all_stopped ? 0 : 1;
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
  std::printf("%s\n", !film.has_sound ? ", no sound"
                      : report.silent ? ", with sound that cannot be decoded"
                                      : ", with sound");
  std::printf("Played         %.1f s", seconds);
  if (GST_CLOCK_TIME_IS_VALID(film.duration))
    std::printf(" of %.1f s", static_cast<double>(film.duration) / GST_SECOND);
  if (report.stopped)
    std::printf(" (stopped)");
  std::printf("\n");
  if (!report.ended_early.empty())
    std::printf("Film broken    it ends here: %s\n", report.ended_early.c_str());
  else if (!report.stopped && GST_CLOCK_TIME_IS_VALID(film.duration)
           && static_cast<double>(report.reached)
                  < 0.98 * static_cast<double>(film.duration) - 0.25 * GST_SECOND)
    std::printf("Film broken    it ends here, before the length that its header states: is the "
                "file truncated?\n");
  std::printf("Frames         %llu, of which %llu are felt\n", number(report.analysis, "frames"),
              number(report.analysis, "active"));
  std::printf("Analysis       %.2f ms per frame (longest %.2f ms)\n",
              milliseconds(report.analysis, "analysis-mean"),
              milliseconds(report.analysis, "analysis-max"));
  std::printf("Commands       %llu issued, %llu late, %llu coalesced\n",
              number(report.chair, "issued"), number(report.chair, "late"),
              number(report.chair, "coalesced"));
  std::printf("Schedule error %.2f ms p50, %.2f ms p99, %.2f ms max\n",
              milliseconds(report.chair, "error-p50"), milliseconds(report.chair, "error-p99"),
              milliseconds(report.chair, "error-max"));
}

int
run(const Options &options)
{
  for (const char *name : { "saliencytactile", "tactileextractor", "tactileoverlay", "tactorsink",
                            "tactiletestsrc" }) {
    GstElementFactory *factory = gst_element_factory_find(name);
    if (!factory) {
      throw std::runtime_error(
          std::string("GStreamer has no element '") + name
          + "'; install the project (meson install) or start with pipelines/play.sh");
    }
    gst_object_unref(factory);
  }

  const Film film
      = options.films && options.films[0] ? discover_film(options.films[0]) : synthetic_film();

  PlaySettings settings;
  settings.window = !options.no_window && have_display();
  settings.quiet = options.manner.quiet;
  settings.progress_in_place = isatty(STDERR_FILENO);
  settings.analysis_options
      = std::string("profile=") + (options.profile ? options.profile : "tuned")
        + " rows=" + std::to_string(options.rows) + " columns=" + std::to_string(options.columns);
  char rate[G_ASCII_DTOSTR_BUF_SIZE];
  settings.chair_options
      = std::string("rate=") + g_ascii_dtostr(rate, sizeof rate, options.rate)
        + " compensation=" + (options.compensation ? options.compensation : "exact");

  const std::filesystem::path directory = options.output ? options.output : ".";
  if (options.print_pipeline) {
    settings.recording = directory / kRecording;
    settings.commands = directory / "commands.csv";
    std::puts(shell_command(film, settings).c_str());
    return 0;
  }

  prepare_directory(directory);
  if (!settings.window && is_same_file(film.uri, directory / kRecording))
    throw std::runtime_error("the recording would overwrite the film; give another --output");
  Output recording(directory, kRecording);
  Output commands(directory, "commands.csv");
  Output picture(directory, "strip.png");
  settings.recording = recording.part_path();
  settings.commands = commands.part_path();

  Strip strip(film.duration, kStripFrames);
  const PlayReport report = play(film, settings, strip);
  if (!report.failure.empty())
    throw std::runtime_error(report.failure);
  if (!report.played && !report.stopped)
    throw std::runtime_error("'" + film.title + "' has no frame that can be decoded");

  // Files first: the report may be read by a program that does not wait for its end.
  std::string written;
  const auto commit = [&written](Output &output) {
    if (output.commit())
      written += (written.empty() ? "" : ", ") + output.final_path().lexically_normal().string();
  };
  if (report.recorded && report.played)
    commit(recording);
  commit(commands);
  if (strip.write(picture.part_path()))
    commit(picture);

  print_report(film, report);
  if (!settings.window && report.played && !report.recorded)
    std::printf("Recording      not finished, so not kept\n");
  std::printf("Written        %s\n", written.empty() ? "nothing" : written.c_str());
  return 0;
}

} // namespace

int
main(int argc, char **argv)
{
  std::signal(SIGPIPE, SIG_IGN); // a reader that went away must not stop the motors' way to zero
  Options options;
  int status = 0;
  if (!parse_options(argc, argv, options, status))
    return status;
  try {
    return options.release_boards ? release_boards() : run(options);
  } catch (const std::exception &e) {
    complain(e.what());
    return 1;
  }
}
