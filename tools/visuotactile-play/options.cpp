// SPDX-License-Identifier: LGPL-2.1-or-later
#include "options.h"

#include "film/analysis.h"
#include "film/known_driver.h"
#include "film/sound.h"
#include "film/user_defaults.h"
#include "translation.h"

#include <gst/gst.h>

#include <limits>
#include <string_view>
#include <utility>

namespace {

constexpr std::string_view kPeople[] = { "auto", "off", "fast", "thorough" };
constexpr std::string_view kCameras[] = { "off", "gentle" };
constexpr std::string_view kCompensations[] = { "exact", "frame-block", "none" };

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
  UserDefaults defaults(kProgram, true);
  fill(options, defaults);
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &options.output.value,
      N_("Write commands.csv and strip.png to this folder and, if no window shows the film, "
         "visuotactile.mkv (default: write nothing)"),
      "DIR" },
    { "no-window", 'n', 0, G_OPTION_ARG_NONE, &options.no_window,
      N_("Show no window even with a display"), nullptr },
    { "driver", 'd', 0, G_OPTION_ARG_STRING, &options.driver.value,
      N_("Driver of tactorsink, or audio for shakers at a sound card (default: the user's, else "
         "auto)"),
      "NAME" },
    { "device", 0, 0, G_OPTION_ARG_STRING, &options.device.value,
      N_("Device of the driver, a name that --list-devices prints"), "ID" },
    { "channels", 0, 0, G_OPTION_ARG_INT, &options.channels,
      N_("Channels of the sound card, 1 to 64 (default: 2)"), "N" },
    { "intensity", 'i', 0, G_OPTION_ARG_DOUBLE, &options.intensity,
      N_("Factor on all vibration, 0 to 1 (default: 1)"), "FACTOR" },
    { "list-devices", 0, 0, G_OPTION_ARG_NONE, &options.list_devices,
      N_("Print the connected devices with their options, and exit"), nullptr },
    { "feel-test", 0, 0, G_OPTION_ARG_NONE, &options.feel_test,
      N_("Drive one motor after the other for half a second, name each, and exit"), nullptr },
    { "motor", 0, 0, G_OPTION_ARG_INT, &options.motor,
      N_("With --feel-test: drive only this motor, from 1 on (default: all)"), "N" },
    { "profile", 'p', 0, G_OPTION_ARG_STRING, &options.profile.value,
      N_("Profile of the analysis: tuned (default) or paper"), "NAME" },
    { "rows", 'r', 0, G_OPTION_ARG_INT, &options.rows,
      N_("Rows of tactors, 1 to 64 (default: the device's, else 3)"), "N" },
    { "columns", 'c', 0, G_OPTION_ARG_INT, &options.columns,
      N_("Columns of tactors, 1 to 64 (default: the device's, else 3)"), "N" },
    { "rate", 0, 0, G_OPTION_ARG_DOUBLE, &options.rate,
      N_("Rate in Hz at which levels may change; 0: with every frame (default: 5, and 0 with a "
         "track)"),
      "HZ" },
    { "sensitivity", 0, 0, G_OPTION_ARG_DOUBLE, &options.sensitivity,
      N_("Factor on the contrast of events, 0.1 to 10 (default: 1)"), "FACTOR" },
    { "density", 0, 0, G_OPTION_ARG_DOUBLE, &options.density,
      N_("Largest share of the time with vibration, 0 to 1; 0: any (default)"), "SHARE" },
    { "people", 0, 0, G_OPTION_ARG_STRING, &options.people.value,
      N_("Detect faces and prefer events in them: auto (default; as fast, if the face detector is "
         "installed), off, fast or thorough; without effect in the profile paper"),
      "NAME" },
    { "camera", 0, 0, G_OPTION_ARG_STRING, &options.camera.value,
      N_("A soft wave in the direction in which the camera travels: off (default) or gentle; "
         "without effect in the profile paper"),
      "NAME" },
    { "sound", 0, 0, G_OPTION_ARG_STRING, &options.sound.value, kSoundHelp, "PROFILE" },
    { "compensation", 0, 0, G_OPTION_ARG_STRING, &options.compensation.value,
      N_("Compensation of the motors' rise time: exact (default), frame-block or none"), "NAME" },
#ifdef HAVE_LIBRARY
    { "tracks", 't', 0, G_OPTION_ARG_FILENAME, &options.tracks.value,
      N_("Play the film's track instead of analyzing the film: the track beside it or in this "
         "folder of tracks; DIR may also be the folder's address on a web server"),
      "DIR" },
#endif
    { "print-pipeline", 0, 0, G_OPTION_ARG_NONE, &options.print_pipeline,
      N_("Print the gst-launch-1.0 line and exit"), nullptr },
    { "release-boards", 0, 0, G_OPTION_ARG_NONE, &options.release_boards,
      N_("Stop the motors of boards that a killed player has left (with --device: of this board), "
         "return the boards to the system, and exit"),
      nullptr },
    { "version", 0, 0, G_OPTION_ARG_NONE, &options.version, N_("Print the version and exit"),
      nullptr },
    {},
  };
  options.films = parse_options(
      argc, argv, entries, options.common,
      { .arguments = "[FILM]",
        .summary
        = N_("Plays a film and drives a grid of vibration motors by the events that draw the "
             "eye.\nFILM is a file or a URI; without FILM, the program plays a synthetic "
             "film.\n\nWith a display, a window shows the film with its tactile overlay. Without a "
             "display,\nthe film drives the motors in real time, too. --output=DIR writes the "
             "commands to the\nchair to DIR/commands.csv, a few frames with their maps to "
             "DIR/strip.png and, without a\nwindow, the film with its overlay to "
             "DIR/visuotactile.mkv. Existing files are replaced\nonly with --force.\n\nKeys in the "
             "window: Space pauses, Left and Right move by 10 s, Down and Up by a minute,\n+ and - "
             "change the intensity of the vibration, M switches it off and on, F fills the "
             "screen,\nQ quits. 1 and 2 change the sensitivity, 3 and 4 the density. After these "
             "keys, and with\n--sensitivity or --density, a bar at the lower edge of the picture "
             "shows the strongest event\nof each frame; events that pass the red mark are "
             "felt.\n\nIf an option is missing, the user's setting applies: see "
             "visuotactile-settings.\n\nCtrl-C ends the film, with all motors at zero and complete "
             "files; a second Ctrl-C ends\nthe program at once."),
        .least = 0,
        .most = std::numeric_limits<std::size_t>::max(),
        .force_help = N_("Replace files of an earlier run"),
        .quiet_help = N_("Print no progress, only the report"),
        .group = gst_init_get_option_group() });
  if (options.version)
    return;
  if (options.films.size() > 1)
    throw UsageError(_("expected one film at the most"));
  for (const auto &[name, side] :
       { std::pair{ "--rows", options.rows }, std::pair{ "--columns", options.columns } })
    if (side != kOfDevice)
      expect_range(name, side, 1, 64);
  if (options.rate != kUsualRate)
    expect_range("--rate", options.rate, 0, 1000);
  expect_range("--sensitivity", options.sensitivity, 0.1, 10);
  expect_range("--density", options.density, 0, 1);
  expect_range("--channels", options.channels, 1, 64);
  expect_range("--intensity", options.intensity, 0, 1);
  expect_one_of("--profile", options.profile.text(), kProfiles);
  expect_one_of("--people", options.people.text(), kPeople);
  expect_one_of("--camera", options.camera.text(), kCameras);
  expect_one_of("--compensation", options.compensation.text(), kCompensations);
  sound_profile(options.sound.text());
  expect_driver(chosen_device(options).driver, kAudio);
  if (options.driver.text() == kAudio && options.compensation.text() != "exact")
    throw UsageError(
        _("--compensation has no effect with --driver=audio, which always compensates exactly"));
  if (options.tracks.is_set() && (options.films.empty() || options.print_pipeline))
    throw UsageError(
        _("--tracks plays the track of a film; expected one, and no --print-pipeline"));
  if (options.motor != 0 && !options.feel_test)
    throw UsageError(_("--motor needs --feel-test"));
  if (options.feel_test && !options.films.empty())
    throw UsageError(_("--feel-test plays no film; expected none"));
  defaults.keep_to_driver(options.driver.text());
  defaults.fill_grid(options.rows, options.columns, kOfDevice);
  options.plays_on = defaults.text(options.driver.text());
}

ChosenDevice
chosen_device(const Options &options)
{
  return { .driver = options.driver.text(),
           .device = options.device.text(),
           .channels = static_cast<unsigned>(options.channels) };
}
