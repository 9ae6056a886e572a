// SPDX-License-Identifier: LGPL-2.1-or-later
#include "session.h"

#include "audio_file.h"
#include "files/regular_file.h"

#include "calibration/alignment.h"
#include "calibration/median.h"
#include "film/or_throw.h"
#include "translation.h"

#include <glib.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace fs = std::filesystem;
using tactor::Time;

namespace {

constexpr const char *kGroup = "Session";
/// For the alignment, before the motors' own band is known.
constexpr tactor::Band kWideBand{ 15, 400 };
constexpr std::uintmax_t kMostBytes = 1 << 20; ///< of session.ini

struct FreeKeyFile
{
  void operator()(GKeyFile *file) const
  {
    g_key_file_unref(file);
  }
};
using KeyFile = std::unique_ptr<GKeyFile, FreeKeyFile>;

std::string
to_text(const tactor::MeasurementSettings &settings, const std::string &motor,
        const std::string &sensor)
{
  const KeyFile file(g_key_file_new());
  std::vector<gint> tactors(settings.tactors.begin(), settings.tactors.end());
  g_key_file_set_string(file.get(), kGroup, "motor", motor.c_str());
  g_key_file_set_string(file.get(), kGroup, "sensor", sensor.c_str());
  g_key_file_set_integer_list(file.get(), kGroup, "tactors", tactors.data(), tactors.size());
  g_key_file_set_double(file.get(), kGroup, "voltage-max", settings.volts_max);
  g_key_file_set_double(file.get(), kGroup, "step-volts", settings.step_volts);
  g_key_file_set_integer(file.get(), kGroup, "repetitions", settings.repetitions);
  g_autofree gchar *text = g_key_file_to_data(file.get(), nullptr, nullptr);
  return text;
}

void
add(Session::Heard &heard, tactor::Recording recording,
    const std::vector<tactor::IssuedCommand> &trace, bool find, tactor::Band band)
{
  if (find) {
    recording.start = tactor::align(recording, trace, band.high_hz > 0 ? band : kWideBand);
    heard.one_clock = false;
  }
  const Time end
      = recording.start
        + Time(std::llround(1e9 * static_cast<double>(recording.size()) / recording.rate));
  heard.runs.push_back(
      { .recording = std::move(recording), .steps = tactor::steps_of(trace, end) });
}

void
respond(Session::Heard &heard, int tactors, tactor::Band band)
{
  const auto measure = [&] {
    heard.band = band.high_hz > 0 ? band : tactor::band_of(heard.runs, tactors);
    heard.responses = tactor::measure_steps(heard.runs, tactors, heard.band);
  };
  measure();
  if (heard.one_clock)
    return;
  // Alignment by sound is late by the delay between voltage and envelope: the first motion.
  for (tactor::RecordedRun &run : heard.runs) {
    std::vector<double> onsets;
    for (const tactor::StepResponse &response : tactor::measure_steps({ run }, tactors, heard.band))
      if (response.fault == tactor::StepFault::none && response.step.rises()
          && response.step.start_volts == 0)
        onsets.push_back(response.onset_ms);
    run.recording.start -= Time(std::llround(1e6 * tactor::median(onsets)));
  }
  measure();
}

} // namespace

Session
Session::begin(const fs::path &folder, const tactor::MeasurementSettings &settings,
               const std::string &motor, const std::string &sensor)
{
  const fs::path path = folder / "session.ini";
  const std::string text = to_text(settings, motor, sensor);
  fs::create_directories(folder);
  const tl::expected<std::string, files::Error> old = files::read(path, kMostBytes);
  if (!old && old.error().number != ENOENT)
    throw std::runtime_error(in_text("cannot read '{}': {}", path.string(), old.error().reason));
  if (old) {
    if (text != *old)
      throw std::runtime_error(in_text("'{}' holds another measurement; expected the same options "
                                       "as in session.ini, or a new folder",
                                       folder.string()));
  } else {
    g_autoptr(GError) error = nullptr;
    if (!g_file_set_contents(path.c_str(), text.c_str(), -1, &error))
      throw std::runtime_error(error->message);
  }
  return open(folder);
}

Session
Session::open(const fs::path &folder)
{
  const KeyFile file(g_key_file_new());
  g_autoptr(GError) error = nullptr;
  const tl::expected<std::string, files::Error> text
      = files::read(folder / "session.ini", kMostBytes);
  if (!text)
    throw std::runtime_error(in_text("'{}' holds no measurement: session.ini: {}", folder.string(),
                                     text.error().reason));
  if (!g_key_file_load_from_data(file.get(), text->data(), text->size(), G_KEY_FILE_NONE, &error))
    throw std::runtime_error(
        in_text("'{}' holds no measurement: {}", folder.string(), error->message));
  Session session;
  session.folder_ = folder;
  gsize count = 0;
  g_autofree gint *tactors
      = g_key_file_get_integer_list(file.get(), kGroup, "tactors", &count, nullptr);
  session.settings_.tactors.assign(tactors, tactors + count);
  session.settings_.volts_max = g_key_file_get_double(file.get(), kGroup, "voltage-max", nullptr);
  session.settings_.step_volts = g_key_file_get_double(file.get(), kGroup, "step-volts", nullptr);
  session.settings_.repetitions
      = g_key_file_get_integer(file.get(), kGroup, "repetitions", nullptr);
  g_autofree gchar *motor = g_key_file_get_string(file.get(), kGroup, "motor", nullptr);
  g_autofree gchar *sensor = g_key_file_get_string(file.get(), kGroup, "sensor", nullptr);
  session.motor_ = motor ? motor : "";
  session.sensor_ = sensor ? sensor : "";
  auto plan = tactor::plan_measurement(session.settings_);
  session.plan_ = or_throw(std::move(plan).map_error([&](const std::string &reason) {
    return "'" + folder.string() + "' holds no measurement: " + reason;
  }));
  return session;
}

int
Session::runs() const
{
  return static_cast<int>(plan_.size());
}

fs::path
Session::file(int run, const char *ending) const
{
  g_autofree gchar *name = g_strdup_printf("run-%03d%s", run, ending);
  return folder_ / name;
}

/// Empty if there is none.
fs::path
Session::recording_of(int run) const
{
  const std::string stem = file(run, "").filename();
  for (const char *ending : { ".wav", ".recording.csv" })
    if (fs::exists(file(run, ending)))
      return file(run, ending);
  for (const fs::directory_entry &entry : fs::directory_iterator(folder_))
    if (entry.path().stem() == stem && entry.path().extension() != ".csv"
        && entry.path().extension() != ".part")
      return entry.path();
  return {};
}

bool
Session::is_done(int run, bool recorded) const
{
  return fs::exists(file(run, ".csv")) && (!recorded || !recording_of(run).empty());
}

int
Session::tactors() const
{
  return *std::ranges::max_element(settings_.tactors) + 1;
}

Time
Session::length(int run) const
{
  return tactor::length_of(plan_.at(static_cast<std::size_t>(run)));
}

std::vector<Frame>
Session::frames(int run) const
{
  std::vector<Frame> frames;
  for (const tactor::MeasurementStretch &stretch : plan_.at(static_cast<std::size_t>(run))) {
    Frame frame{ .begin = stretch.begin,
                 .duration = stretch.duration,
                 .levels = std::vector<float>(static_cast<std::size_t>(tactors())) };
    frame.levels[static_cast<std::size_t>(stretch.tactor)]
        = static_cast<float>(stretch.volts / settings_.volts_max);
    frames.push_back(std::move(frame));
  }
  return frames;
}

void
Session::keep(int run, const Played &played) const
{
  if (played.recording.size() > 0)
    write_recording(played.recording, file(run, ".wav"));
  const fs::path part = file(run, ".csv.part");
  {
    tactor::CommandTrace trace = or_throw(tactor::CommandTrace::create(part));
    for (const tactor::IssuedCommand &issued : played.trace)
      trace.write(issued);
    trace.flush();
    if (trace.failed())
      throw std::runtime_error(in_text("cannot write '{}': is the disk full?", part.string()));
  }
  fs::rename(part, file(run, ".csv")); // last: marks the run as done
}

Session::Heard
Session::measure(tactor::Band band, bool find) const
{
  Heard heard;
  for (int run = 0; run < runs(); run++) {
    if (!is_done(run, true))
      continue;
    // measure writes .wav; recordings of other devices have other endings.
    const fs::path recording = recording_of(run);
    add(heard, read_recording(recording), or_throw(tactor::read_command_trace(file(run, ".csv"))),
        find || recording.extension() != ".wav" || sensor_.empty(), band);
  }
  if (heard.runs.empty())
    throw std::runtime_error(in_text("'{}' holds no recorded run yet", folder_.string()));
  respond(heard, tactors(), band);
  return heard;
}

const std::string &
Session::motor() const
{
  return motor_;
}

const std::string &
Session::sensor() const
{
  return sensor_;
}

const tactor::MeasurementSettings &
Session::settings() const
{
  return settings_;
}

Session::Heard
measure_recording(tactor::Recording recording, const std::vector<tactor::IssuedCommand> &trace,
                  int tactors, tactor::Band band, bool find)
{
  Session::Heard heard;
  add(heard, std::move(recording), trace, find, band);
  respond(heard, tactors, band);
  return heard;
}
