// SPDX-License-Identifier: LGPL-2.1-or-later
#include "commands.h"
#include "options.h"
#include "pictures.h"
#include "session.h"

#include "calibration/tactor_calibration.h"
#include "film/picture.h"
#include "translation.h"

#include <gst/gst.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <stdexcept>

/// Pixels of a PNG per unit of the picture.
static constexpr double kPixels = 2;

int
show(int argc, char **argv)
{
  TextOption band;
  TextOption output;
  gint tactor = 0;
  gdouble start = 0;
  gdouble target = -1;
  CommonOptions common;
  const GOptionEntry entries[] = {
    { "output", 'o', 0, G_OPTION_ARG_FILENAME, &output.value,
      N_("Name of the pictures to write or replace, NAME.svg or NAME.png (default: "
         "FOLDER/tactor-N.svg)"),
      "PICTURE" },
    { "tactor", 't', 0, G_OPTION_ARG_INT, &tactor, N_("Tactor to draw (default: 0)"), "N" },
    { "from", 0, 0, G_OPTION_ARG_DOUBLE, &start,
      N_("Start voltage of the rise in NAME-envelope (default: 0)"), "V" },
    { "to", 0, 0, G_OPTION_ARG_DOUBLE, &target,
      N_("Target voltage of that rise (default: the highest)"), "V" },
    { "band", 'b', 0, G_OPTION_ARG_STRING, &band.value,
      N_("Band to filter, in Hz (default: detected)"), "LOW:HIGH" },
    {},
  };
  const std::vector<std::string> arguments = parse_options(
      argc, argv, entries, common,
      { .arguments = "FOLDER",
        .summary = N_("Draws three pictures of a tactor: NAME-envelope (one rise and its 90 "
                      "%),\nNAME-rise-times (all rises and the fit) and NAME-residuals."),
        .least = 1,
        .most = 1 });
  const std::string name = output.is_set()
                               ? output.text()
                               : arguments.front() + "/tactor-" + std::to_string(tactor) + ".svg";
  if (!is_picture_name(name))
    throw UsageError(_("expected a PICTURE that ends in .png or .svg"));
  gst_init(nullptr, nullptr);
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
    throw std::runtime_error(
        in_text("tactor {} has no rise that could be measured", std::to_string(tactor)));

  // The rise nearest to --from and --to.
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
    throw std::runtime_error(in_text("tactor {} has no rise", std::to_string(tactor)));
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
    if (!common.quiet)
      std::printf(_("written: %s\n"), path.c_str());
  };
  write("envelope", [&](cairo_t *cairo) { draw_envelope(cairo, response, envelope); });
  write("rise-times", [&](cairo_t *cairo) { draw_surface(cairo, *calibration, own); });
  write("residuals", [&](cairo_t *cairo) { draw_residuals(cairo, *calibration, own); });
  return 0;
}
