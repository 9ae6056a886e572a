// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "pictures.h"
#include "session.h"

#include "../cairo_picture.h"

#include <cmath>
#include <cstdio>
#include <functional>
#include <stdexcept>

/// Of a PNG, for each unit of a picture.
static constexpr double kPixels = 2;

int
run_show(int argc, char **argv)
{
  TextOption band;
  TextOption output;
  gint tactor = 0;
  gdouble start = 0;
  gdouble target = -1;
  Manner manner;
  std::vector<std::string> arguments;
  if (!parse_options(
          argc, argv, "FOLDER",
          "Pictures of one tactor: NAME-envelope (a rise and its 90 %), NAME-rise-times (all of "
          "them "
          "and the fit),\nNAME-residuals.",
          { { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
              "NAME.svg or NAME.png (default: FOLDER/tactor-N.svg)", "PICTURE" },
            { "tactor", 't', 0, G_OPTION_ARG_INT, &tactor, "Which (default: 0)", "N" },
            { "from", 0, 0, G_OPTION_ARG_DOUBLE, &start, "Start voltage of the rise (default: 0)",
              "V" },
            { "to", 0, 0, G_OPTION_ARG_DOUBLE, &target, "Its target (default: the highest)", "V" },
            { "band", 'b', 0, G_OPTION_ARG_STRING, &band.value, "As for analyse", "LOW:HIGH" } },
          manner.entries(Manner::kWritesAnyway, Manner::kSaysOnlyFaults), arguments))
    return 2;
  if (arguments.size() != 1) {
    std::fprintf(stderr, "tactor-calibrate: show expects one FOLDER\n");
    return 2;
  }
  const std::string name = output.is_set()
                               ? output.text()
                               : arguments.front() + "/tactor-" + std::to_string(tactor) + ".svg";
  if (!is_picture_name(name)) {
    std::fprintf(stderr, "tactor-calibrate: show expects a PICTURE that ends in .png or .svg\n");
    return 2;
  }
  const std::string stem = name.substr(0, name.size() - 4);
  const std::string ending = name.substr(name.size() - 4);
  const Session session = Session::open(arguments.front());
  Session::Heard heard = session.measure(parse_band(band.text()));
  std::vector<tactor::StepResponse> own;
  for (const tactor::StepResponse &response : heard.responses)
    if (response.step.tactor == tactor)
      own.push_back(response);
  const std::optional<tactor::TactorCalibration> calibration
      = tactor::calibrate_tactor(own, heard.one_clock);
  if (!calibration)
    throw std::runtime_error("tactor " + std::to_string(tactor)
                             + " has no rise that could be measured");

  // The nearest to what was asked for.
  const tactor::RecordedRun *run = nullptr;
  tactor::Step step;
  double nearest = 1e9;
  for (const tactor::RecordedRun &candidate : heard.runs)
    for (const tactor::Step &other : candidate.steps) {
      const double wanted = target >= 0 ? target : session.settings().volts_max;
      const double distance
          = std::abs(other.start_volts - start) + std::abs(other.target_volts - wanted);
      if (other.tactor != tactor || !other.rises() || distance >= nearest)
        continue;
      nearest = distance;
      run = &candidate;
      step = other;
    }
  if (!run)
    throw std::runtime_error("tactor " + std::to_string(tactor) + " has no rise");
  int tactors = 1;
  for (const int index : session.settings().tactors)
    tactors = std::max(tactors, index + 1);
  tactor::StepEnvelope envelope;
  const tactor::StepResponse response
      = tactor::measure_step(run->recording, run->recording.channel_of(tactor, tactors), step,
                             heard.band, tactor::prior_of(own), &envelope);

  const auto write = [&](const char *what, const std::function<void(cairo_t *)> &draw) {
    const std::string path = stem + "-" + what + ending;
    write_picture(path, kPictureWidth, kPictureHeight, kPixels, draw);
    if (!manner.quiet)
      std::printf("written: %s\n", path.c_str());
  };
  write("envelope", [&](cairo_t *cairo) { draw_envelope(cairo, response, envelope); });
  write("rise-times", [&](cairo_t *cairo) { draw_surface(cairo, *calibration, own); });
  write("residuals", [&](cairo_t *cairo) { draw_residuals(cairo, *calibration, own); });
  return 0;
}
