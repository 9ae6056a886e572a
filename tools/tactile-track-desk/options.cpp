// SPDX-License-Identifier: LGPL-2.1-or-later
#include "options.h"
#include "translation.h"

#include <vector>

void
read_desk_options(int argc, char **argv, DeskOptions &options, UserDefaults &defaults)
{
  constexpr int kHighestPort = 65535;
  const GOptionEntry entries[] = {
    { "review", 0, 0, G_OPTION_ARG_NONE, &options.review,
      N_("Show draft and track side by side, to accept or reject cue by cue"), nullptr },
    { "port", 0, 0, G_OPTION_ARG_INT, &options.port,
      N_("Port of 127.0.0.1, 0 to 65535; 0 (default): the usual one of this track, or any free "
         "one"),
      "N" },
    { "no-browser", 0, 0, G_OPTION_ARG_NONE, &options.no_browser,
      N_("Open no browser: only print the address"), nullptr },
    { "tracks", 't', 0, G_OPTION_ARG_FILENAME, &options.tracks.value,
      N_("Folder of tracks, or its address on a web server; FILM's track is copied from there if "
         "there is none beside FILM"),
      "DIR" },
    {},
  };
  options.chair.fill(defaults);
  const auto chair = options.chair.entries();
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, options.common,
      { .arguments = "FILM [TRACK]",
        .summary
        = N_("Edits a track beside its film, in your browser. TRACK is WebVTT. Without TRACK, the "
             "desk\nopens the track beside the film; if there is none, the track of --tracks, or a "
             "draft,\nwhich it makes first. Each edit is stored on the disk at once, and TRACK "
             "when you save.\nCtrl-C ends the desk, with all motors at zero."),
        .least = 1,
        .most = 2,
        .more = chair.data() });
  expect_range("--port", options.port, 0, kHighestPort);
  options.chair.check(defaults);
  options.film = arguments[0];
  if (arguments.size() > 1)
    options.track = arguments[1];
}
