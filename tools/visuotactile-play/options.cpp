// SPDX-License-Identifier: LGPL-2.1-or-later
#include "options.h"

#include "film/known_driver.h"
#include "film/sound.h"
#include "film/user_defaults.h"

#include <gst/gst.h>

#include <algorithm>
#include <initializer_list>
#include <limits>

namespace {

void
fill(Options &options, UserDefaults &defaults)
{
  defaults.fill("driver", options.driver);
  defaults.fill_of_driver("device", options.device);
  defaults.fill_of_driver("mapping", options.mapping);
  defaults.fill_of_driver("calibration", options.calibration);
  defaults.fill("intensity", options.intensity);
  defaults.fill("mute", options.mute);
  defaults.fill(chair::kDelay, options.delay);
  defaults.fill("sensitivity", options.sensitivity);
  defaults.fill("density", options.density);
  defaults.fill("people", options.people);
  defaults.fill("sound", options.sound);
}

} // namespace

void
read_command_line(int argc, char **argv, Options &options)
{
  UserDefaults defaults(kProgram);
  fill(options, defaults);
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &options.output.value,
      "Write commands.csv and strip.png to this folder, and visuotactile.mkv if no window shows "
      "the film (default: nothing is written)",
      "DIR" },
    { "no-window", 'n', 0, G_OPTION_ARG_NONE, &options.no_window,
      "Show no window even with a display", nullptr },
    { "driver", 'd', 0, G_OPTION_ARG_STRING, &options.driver.value,
      "Driver of tactorsink, or audio for shakers at a sound card (default: the "
      "user's, else auto)",
      "NAME" },
    { "device", 0, 0, G_OPTION_ARG_STRING, &options.device.value,
      "Device of the driver, a name that --list-devices prints", "ID" },
    { "channels", 0, 0, G_OPTION_ARG_INT, &options.channels,
      "Channels of the sound card, 1 to 64 (default: 2)", "N" },
    { "intensity", 'i', 0, G_OPTION_ARG_DOUBLE, &options.intensity,
      "Factor on all vibration, 0 to 1 (default: 1)", "FACTOR" },
    { "list-devices", 0, 0, G_OPTION_ARG_NONE, &options.list_devices,
      "Print the connected devices with their options, and exit", nullptr },
    { "feel-test", 0, 0, G_OPTION_ARG_NONE, &options.feel_test,
      "Drive one motor after the other for half a second, name each, and exit", nullptr },
    { "motor", 0, 0, G_OPTION_ARG_INT, &options.motor,
      "Only this motor of --feel-test, from 1 (default: all)", "N" },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &options.profile.value,
      "Profile of the analysis: tuned (default) or paper", "NAME" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &options.rows,
      "Rows of tactors, 1 to 64 (default: the device's, else 3)", "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &options.columns,
      "Columns of tactors, 1 to 64 (default: the device's, else 3)", "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &options.rate,
      "Rate in Hz at which levels may change; 0: with every frame (default: 5, and 0 with a track)",
      "HZ" },
    { "sensitivity", 0, 0, G_OPTION_ARG_DOUBLE, &options.sensitivity,
      "Factor on the contrast of events, 0.1 to 10 (default: 1)", "FACTOR" },
    { "density", 0, 0, G_OPTION_ARG_DOUBLE, &options.density,
      "Share of the time that may be felt, 0 to 1; 0: any (default)", "SHARE" },
    { "people", 0, 0, G_OPTION_ARG_STRING, &options.people.value,
      "Detect faces and prefer events in them: off (default), fast or thorough; not "
      "with the profile paper",
      "NAME" },
    { "camera", 0, 0, G_OPTION_ARG_STRING, &options.camera.value,
      "A soft wave in the direction in which the camera travels: off (default) or gentle; not "
      "with the profile paper",
      "NAME" },
    { "sound", 0, 0, G_OPTION_ARG_STRING, &options.sound.value, kSoundHelp, "PROFILE" },
    { "compensation", 0, 0, G_OPTION_ARG_STRING, &options.compensation.value,
      "Compensation of the motors' rise time: exact (default), frame-block or none", "NAME" },
#ifdef HAVE_LIBRARY
    { "tracks", 't', 0, G_OPTION_ARG_FILENAME, &options.tracks.value,
      "Play the track that is beside the film or in this folder of tracks, or its address on a web "
      "server, instead of what the analysis finds",
      "DIR" },
#endif
    { "print-pipeline", 0, 0, G_OPTION_ARG_NONE, &options.print_pipeline,
      "Print the gst-launch-1.0 line and exit", nullptr },
    { "release-boards", 0, 0, G_OPTION_ARG_NONE, &options.release_boards,
      "Stop the motors of boards that a killed player left, or of --device alone, return the "
      "boards "
      "to the system, and exit",
      nullptr },
    { "version", 0, 0, G_OPTION_ARG_NONE, &options.version, "Print the version and exit", nullptr },
    {},
  };
  options.films = parse_options(
      argc, argv, entries, options.common,
      { .arguments = "[FILM]",
        .summary
        = "Plays a film and drives an array of vibration motors by what draws the eye in "
          "it.\nFILM is a file or a URI; without one, a synthetic film is played.\n\n"
          "With a display, a window shows the film with its tactile overlay. Without a "
          "display,\nthe film drives the motors in real time all the same. With --output=DIR, "
          "the commands\nto the chair are written to DIR/commands.csv, a few frames with their "
          "maps to\nDIR/strip.png, and without a window the film with its overlay to "
          "DIR/visuotactile.mkv.\nExisting files are replaced only with --force.\n\n"
          "Keys in the window: Space pauses, Left and Right move by 10 s, Down and Up by a "
          "minute,\n+ and - change the intensity of the vibration, M switches it off and on, Q "
          "quits. 1 and 2\nchange the sensitivity, 3 and 4 the density; then, as with "
          "--sensitivity or --density, a bar\nat the picture's lower edge shows the strongest "
          "event, which is felt where the bar passes\nthe red mark.\n\n"
          "Options that are not given are the settings of the user: see visuotactile-settings.\n\n"
          "Ctrl-C ends the film, with all motors at zero and complete files; a second "
          "Ctrl-C\nends it at once.",
        .least = 0,
        .most = std::numeric_limits<std::size_t>::max(),
        .force_help = "Replace files of an earlier run",
        .quiet_help = "Print no progress, only the report",
        .group = gst_init_get_option_group() });
  const auto is_one_of = [](const TextOption &option, std::initializer_list<const char *> values) {
    return std::ranges::find(values, option.text()) != values.end();
  };
  if (options.version)
    return;
  if (options.films.size() > 1)
    throw UsageError("expected one film at the most");
  for (const gint side : { options.rows, options.columns })
    if (side != kOfDevice && (side < 1 || side > 64))
      throw UsageError("--rows and --columns are whole numbers from 1 to 64");
  if (options.rate != kUsualRate && !(options.rate >= 0 && options.rate <= 1000))
    throw UsageError("--rate is a number of Hz from 0 to 1000");
  if (!(options.sensitivity >= 0.1 && options.sensitivity <= 10))
    throw UsageError("--sensitivity is a number from 0.1 to 10");
  if (!(options.density >= 0 && options.density <= 1))
    throw UsageError("--density is a number from 0 to 1");
  if (options.channels < 1 || options.channels > 64)
    throw UsageError("--channels is a whole number from 1 to 64");
  if (!(options.intensity >= 0 && options.intensity <= 1))
    throw UsageError("--intensity is a number from 0 to 1");
  if (!is_one_of(options.profile, { "tuned", "paper" }))
    throw UsageError("--profile is tuned or paper");
  if (!is_one_of(options.people, { "off", "fast", "thorough" }))
    throw UsageError("--people is off, fast or thorough");
  if (!is_one_of(options.camera, { "off", "gentle" }))
    throw UsageError("--camera is off or gentle");
  if (!is_one_of(options.compensation, { "exact", "frame-block", "none" }))
    throw UsageError("--compensation is exact, frame-block or none");
  sound_profile(options.sound.text());
  expect_driver(chosen_device(options).driver, kAudio);
  if (options.driver.text() == kAudio && options.compensation.text() != "exact")
    throw UsageError("--compensation is of tactorsink; with --driver=audio it is always exact");
  if (options.tracks.is_set() && (options.films.empty() || options.print_pipeline))
    throw UsageError("--tracks plays the track of a film; expected one, and no --print-pipeline");
  if (options.motor != 0 && !options.feel_test)
    throw UsageError("--motor is of --feel-test");
  if (options.feel_test && !options.films.empty())
    throw UsageError("--feel-test plays no film; expected none");
  defaults.keep_to_driver(options.driver.text());
  defaults.fill_grid(options.rows, options.columns, kOfDevice);
  if (!options.common.quiet && !options.list_devices && !options.release_boards)
    defaults.print();
}

ChosenDevice
chosen_device(const Options &options)
{
  return { .driver = options.driver.text(),
           .device = options.device.text(),
           .channels = static_cast<unsigned>(options.channels) };
}
