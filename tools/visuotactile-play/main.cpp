// SPDX-License-Identifier: LGPL-2.1-or-later
//
// visuotactile-play: plays a film on screen (or records it) and on the chair, and prints a report.
#include "devices.h"
#include "display.h"
#include "options.h"
#include "player.h"
#include "strip.h"
#ifdef HAVE_LIBRARY
#include "stored_track.h"
#endif

#include "film/command_line.h"
#include "film/film.h"
#include "film/known_driver.h"
#include "film/live_settings.h"
#include "film/motor_walk.h"
#include "film/output.h"
#include "film/sound.h"
#include "tactor/drivers/board_choice.h"
#include "tactor/drivers/release_boards.h"
#include "translation.h"

#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr int kStripFrames = 6;
constexpr const char *kRecording = "visuotactile.mkv";
constexpr const char *kCommands = "commands.csv";
constexpr const char *kStrip = "strip.png";
constexpr gint kPaperSide = 3;

bool
is_same_file(const std::string &uri, const std::filesystem::path &path)
{
  g_autofree gchar *film = g_filename_from_uri(uri.c_str(), nullptr, nullptr);
  std::error_code error;
  return film && std::filesystem::equivalent(film, path, error);
}

/// Throws std::runtime_error if the file exists and may not be replaced.
void
expect_new(const std::filesystem::path &path, bool force)
{
  std::error_code error;
  if (!force && std::filesystem::is_regular_file(path, error))
    throw std::runtime_error(
        in_text("'{}' exists; expected a folder without it, or --force", path.string()));
}

/// Prints a line for each board. Returns the exit status.
int
release_boards(const std::string &device)
{
  const auto released = tactor::release_boards(device);
  if (!released)
    throw std::runtime_error(released.error().text);
  if (released->empty())
    std::puts(_("No board was left by a player that was killed."));
  bool all_stopped = true;
  for (const auto &[device, refusal] : *released) {
    if (refusal)
      print_error(kProgram, in_text("{}: cannot stop its motors: {}", tactor::describe(device),
                                    refusal->text));
    else
      std::printf(_("%s: motors stopped, board returned\n"), tactor::describe(device).c_str());
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
  std::printf(_("\nFilm           %s\n"), film.title.c_str());
  std::printf(_("Picture        %d x %d"), film.width, film.height);
  if (film.fps > 0)
    std::printf(_(", %.5g frames/s"), film.fps);
  std::printf("%s\n", !film.has_sound ? _(", no sound")
                      : report.silent ? _(", with sound that cannot be decoded")
                                      : _(", with sound"));
  std::printf(_("Played         %s%.1f s"), report.moved ? _("to ") : "", seconds);
  if (GST_CLOCK_TIME_IS_VALID(film.duration))
    std::printf(_(" of %.1f s"), static_cast<double>(film.duration) / GST_SECOND);
  if (report.stopped)
    std::printf(_(" (stopped)"));
  std::printf("\n");
  if (!report.ended_early.empty())
    std::printf(_("Film broken    it ends here: %s\n"), report.ended_early.c_str());
  else if (!report.stopped && GST_CLOCK_TIME_IS_VALID(film.duration)
           && static_cast<double>(report.reached)
                  < 0.98 * static_cast<double>(film.duration) - 0.25 * GST_SECOND)
    std::printf(_("Film broken    it ends here, before the length in its header: is the file "
                  "truncated?\n"));
  std::printf(_("Frames         %llu, of which %llu are felt\n"),
              number(report.analysis.get(), "frames"), number(report.analysis.get(), "active"));
  std::printf(_("Analysis       %.2f ms per frame (longest %.2f ms)\n"),
              milliseconds(report.analysis.get(), "analysis-mean"),
              milliseconds(report.analysis.get(), "analysis-max"));
  if (report.chair == nullptr)
    return;
  std::printf(_("Commands       %llu issued, %llu late, %llu coalesced"),
              number(report.chair.get(), "issued"), number(report.chair.get(), "late"),
              number(report.chair.get(), "coalesced"));
  if (const auto expired = number(report.chair.get(), "expired"))
    std::printf(
        _(", %llu expired (too late to be felt: close other programs or play a smaller film)"),
        expired);
  std::printf("\n");
  std::printf(_("Schedule error %.2f ms p50, %.2f ms p99, %.2f ms max\n"),
              milliseconds(report.chair.get(), "error-p50"),
              milliseconds(report.chair.get(), "error-p99"),
              milliseconds(report.chair.get(), "error-max"));
}

/// A number as on a launch line, in any locale.
std::string
number_text(double number)
{
  char text[G_ASCII_DTOSTR_BUF_SIZE];
  return g_ascii_dtostr(text, sizeof text, number);
}

/// The sink of the maps with its properties, as on a launch line.
std::string
chair_line(const Options &options)
{
  std::string line = sink_line(chosen_device(options));
  if (options.intensity != 1)
    line += " intensity=" + number_text(options.intensity);
  if (options.mute)
    line += " mute=true";
  if (options.delay != 0 && options.driver.text() != kAudio)
    line += " delay=" + number_text(options.delay);
  if (options.mapping.is_set())
    line += " mapping=" + launch_value(options.mapping.text());
  if (options.calibration.is_set() && options.driver.text() != kAudio)
    line += " calibration=" + launch_value(options.calibration.text());
  return line;
}

/// Throws std::runtime_error if GStreamer lacks an element.
void
expect_elements(std::span<const char *const> names)
{
  for (const char *name : names) {
    GstElementFactory *factory = gst_element_factory_find(name);
    if (!factory) {
      throw std::runtime_error(in_text("GStreamer has no element '{}'; install the project (meson "
                                       "install) or start with pipelines/play.sh",
                                       name));
    }
    gst_object_unref(factory);
  }
}

void
say_driver(const Options &options)
{
  if (!options.common.quiet)
    std::fprintf(stderr, "%s: %s\n", kProgram, options.plays_on.c_str());
}

int
feel_test(const Options &options)
{
  const ChosenDevice chosen = chosen_device(options);
  expect_elements(std::array{ chosen.element() });
  const auto side = [](gint set) {
    return static_cast<unsigned>(set == kOfDevice ? kPaperSide : set);
  };
  MotorWalk motors = motors_of(chosen, side(options.rows), side(options.columns));
  if (options.motor != 0)
    keep_motor(motors, options.motor);
  const Owned<GstElement> sink = make_sink(chair_line(options));
  say_driver(options);
  walk(
      sink.get(), motors,
      [&](const std::string &motor) {
        if (options.common.quiet)
          return;
        std::printf("%s\n", motor.c_str());
        std::fflush(stdout);
      },
      [](const std::string &warning) { print_error(kProgram, warning); });
  return motors_may_run(sink.get()) ? 1 : 0;
}

int
run(const Options &options)
{
  const ChosenDevice chosen = chosen_device(options);
  expect_elements(std::array{ "saliencytactile", "tactileextractor", "tactileoverlay",
                              chosen.element(), "tactiletestsrc" });
  const Film film = options.films.empty() ? synthetic_film() : discover_film(options.films.front());

  PlaySettings settings;
  settings.quiet = options.common.quiet;
  settings.plays_on = options.plays_on;
#ifdef HAVE_LIBRARY
  const std::optional<StoredTrack> track
      = options.tracks.is_set() ? StoredTrack::find(film, options.tracks.text()) : std::nullopt;
  if (track) {
    expect_elements(std::array{ "subparse", "tactileconverter", "tactilecombiner" });
    settings.track = track->path();
    if (!settings.quiet)
      std::printf(_("Track          %s\n"), track->source().c_str());
  } else if (options.tracks.is_set()) {
    print_error(kProgram, in_text("there is no track for '{}': what the analysis finds is played",
                                  film.title));
  }
#endif
  // A track replaces the maps of the sound and of people, which nothing else needs.
  const bool has_track = !settings.track.empty();
  settings.sound = has_track ? nullptr : sound_profile(options.sound.text());
  if (settings.sound)
    expect_elements(kSoundElements);
  const std::string sink = options.no_window ? "" : video_sink();
  settings.window = !sink.empty();
  // That of Wayland has a window of its own, and ximagesink does not fit the film into ours.
  settings.titled
      = sink == "xvimagesink" || (sink == "glimagesink" && g_getenv("WAYLAND_DISPLAY") == nullptr);
  settings.analysis_options = "profile=" + options.profile.text();
  if (options.rows != kOfDevice)
    settings.analysis_options += " rows=" + std::to_string(options.rows);
  if (options.columns != kOfDevice)
    settings.analysis_options += " columns=" + std::to_string(options.columns);
  if (options.sensitivity != 1)
    settings.analysis_options += " sensitivity=" + number_text(options.sensitivity);
  if (options.density > 0)
    settings.analysis_options += " density=" + number_text(options.density);
  if (const std::string people = has_track ? "off" : options.people.text(); people != "auto")
    settings.analysis_options += " people=" + people;
  if (!has_track && options.camera.text() != "off")
    settings.analysis_options += " camera=" + options.camera.text();
  settings.meter = options.sensitivity != 1 || options.density > 0;
  const double rate = options.rate != kUsualRate ? options.rate : has_track ? 0 : 5;
  settings.chair = chair_line(options) + " rate=" + number_text(rate);
  settings.has_trace = chosen.driver != kAudio;
  if (settings.has_trace)
    settings.chair += " compensation=" + options.compensation.text();

  const bool writes = options.output.is_set();
  const std::filesystem::path directory = options.output.text();
  if (options.print_pipeline) {
    if (writes) {
      settings.recording = directory / kRecording;
      if (settings.has_trace)
        settings.commands = directory / kCommands;
    }
    say_driver(options);
    std::puts(shell_command(film, settings).c_str());
    return 0;
  }

  std::optional<Output> recording;
  std::optional<Output> commands;
  std::optional<Output> picture;
  if (writes) {
    prepare_directory(directory);
    const auto open = [&](std::optional<Output> &output, const char *name) {
      expect_new(directory / name, options.common.force);
      return output.emplace(directory, name).part_path();
    };
    if (!settings.window) {
      if (is_same_file(film.uri, directory / kRecording))
        throw std::runtime_error(
            _("the recording would overwrite the film; give another --output"));
      settings.recording = open(recording, kRecording);
    }
    if (settings.has_trace)
      settings.commands = open(commands, kCommands);
    open(picture, kStrip);
  }

  Strip strip(film.duration, kStripFrames);
  const PlayReport report = play(film, settings, writes ? &strip : nullptr);
  if (!report.failure.empty())
    throw std::runtime_error(report.failure);
  if (!report.played && !report.stopped)
    throw std::runtime_error(in_text("'{}' has no frame that can be decoded", film.title));

  // The files are complete before the report: its reader may not wait for the program's end.
  std::string written;
  const auto commit = [&written](std::optional<Output> &output) {
    if (output && output->commit())
      written += (written.empty() ? "" : ", ") + output->final_path().lexically_normal().string();
  };
  if (report.recorded && report.played)
    commit(recording);
  commit(commands);
  if (picture && strip.write(picture->part_path()))
    commit(picture);

  print_report(film, report);
  if (recording && report.played && !report.recorded)
    std::printf(_("Recording      not finished, so not kept\n"));
  if (writes)
    std::printf(_("Written        %s\n"), written.empty() ? _("nothing") : written.c_str());
  return report.motors_may_run ? 1 : 0;
}

} // namespace

int
main(int argc, char **argv)
{
  std::signal(SIGPIPE, SIG_IGN); // a reader that went away must not stop the motors' way to zero
  Options options;
  LiveSettings::at_start();
  try {
    read_command_line(argc, argv, options);
    if (options.version) {
      std::puts("visuotactile-play " PACKAGE_VERSION);
      return 0;
    }
    if (options.list_devices)
      return list_devices();
    if (options.feel_test)
      return feel_test(options);
    return options.release_boards ? release_boards(options.device.text()) : run(options);
  } catch (const Help &help) {
    std::fputs(help.text.c_str(), stdout);
    return 0;
  } catch (const UsageError &error) {
    print_error(kProgram, in_text("{}; see --help", error.what()));
    return 2;
  } catch (const std::exception &error) {
    print_error(kProgram, error.what());
    return 1;
  }
}
