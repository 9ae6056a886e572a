// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactor-calibrate: measures the motors of a chair, and shows and checks what was measured.
#include "commands.h"

#include <gst/gst.h>

#include <cstdio>
#include <exception>
#include <string>
#include <utility>

namespace {

constexpr std::pair<const char *, int (*)(int, char **)> kCommands[] = {
  { "measure", run_measure },
  { "analyse", run_analyse },
  { "show", run_show },
  { "check", run_check },
};

constexpr const char *kUsage = "Usage: tactor-calibrate COMMAND [OPTION…]\n\n"
                               "  measure FOLDER   drives the tactors through known steps and "
                               "records them; goes on where it was stopped\n"
                               "  analyse FOLDER   recordings → calibration, those of measure or "
                               "ones that were made elsewhere\n"
                               "  show FOLDER      pictures: envelopes, rise times, residuals\n"
                               "  check            plays a pattern with a calibration and tells "
                               "how far from its frame each 90 % fell\n\n"
                               "All take --force (-f) and --quiet (-q); tactor-calibrate "
                               "COMMAND --help lists a command's options.\n";

} // namespace

int
main(int argc, char **argv)
{
  const std::string name = argc > 1 ? argv[1] : "";
  if (name == "--version") {
    std::printf("tactor-calibrate %s\n", PACKAGE_VERSION);
    return 0;
  }
  if (name == "--help" || name == "-h") {
    std::fputs(kUsage, stdout);
    return 0;
  }
  for (const auto &[command, run] : kCommands) {
    if (name != command)
      continue;
    try {
      gst_init(nullptr, nullptr);
      return run(argc - 1, argv + 1);
    } catch (const std::exception &e) {
      std::fprintf(stderr, "tactor-calibrate: %s\n", e.what());
      return 1;
    }
  }
  std::fprintf(stderr, "tactor-calibrate: expected measure, analyse, show or check, got '%s'\n%s",
               name.c_str(), kUsage);
  return 2;
}
