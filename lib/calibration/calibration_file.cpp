// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration/calibration.h"

#include "files/regular_file.h"
#include "text.h"

#include <glib.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>

namespace tactor {

namespace {

constexpr const char *kGroup = "Calibration";
constexpr const char *kTactorGroup = "Tactor ";
constexpr int kMostTactors = 4096;
constexpr double kMostVolts = 24;
constexpr double kLongestMs = 10'000;
constexpr double kLeastGain = -60; ///< dB
constexpr double kMostGain = 24;   ///< dB
constexpr std::size_t kMostBands = 8;
/// Twice the size of a file with tables of 0.1 V steps for all tactors.
constexpr std::size_t kMostBytes = std::size_t{ 64 } << 20;
/// GKeyFile allocates about 200 bytes per line, including comments and empty lines, and per number
/// in a list.
constexpr std::ptrdiff_t kMostLines = 200'000;
constexpr std::size_t kLongestLine = std::size_t{ 1 } << 20;

using Error = tl::unexpected<std::string>;

/// The content of the file; an error if it cannot be read or is larger than kMostBytes.
tl::expected<std::string, std::string>
contents(const std::string &path)
{
  tl::expected<std::string, files::Error> read = files::read(path, kMostBytes);
  if (!read)
    return Error(read.error().reason);
  const std::string &text = *read;
  std::size_t longest = 0;
  std::ptrdiff_t lines = 0;
  for (std::size_t from = 0; from < text.size(); lines++) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    longest = std::max(longest, to - from);
    from = to + 1;
  }
  if (lines > kMostLines || longest > kLongestLine)
    return Error("expected at most " + std::to_string(kMostLines) + " lines of at most "
                 + std::to_string(kLongestLine) + " bytes");
  return *std::move(read);
}

struct FreeKeyFile
{
  void operator()(GKeyFile *file) const
  {
    g_key_file_unref(file);
  }
};
using KeyFile = std::unique_ptr<GKeyFile, FreeKeyFile>;

/// Up to six significant digits, without trailing zeros, in the C locale.
std::string
text(double value)
{
  char buffer[32];
  const auto end
      = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 6).ptr;
  return { buffer, end };
}

std::string
text(std::span<const double> values)
{
  std::string result;
  for (const double value : values)
    result += text(value) + ";";
  return result;
}

double
to_ms(Time time)
{
  return static_cast<double>(time.count()) / 1e6;
}

Time
from_ms(double ms)
{
  return Time(std::llround(ms * 1e6));
}

/// One group of the file. A value that is missing or invalid reads as the minimum, or nothing; the
/// first such error is stored in the file's `fault`, with its location.
class Reader
{
public:
  Reader(GKeyFile *file, std::string path, std::string group, std::string &fault)
      : file_(file), path_(std::move(path)), group_(std::move(group)), fault_(fault)
  {
  }

  void fail(const std::string &key, const std::string &why) const
  {
    if (fault_.empty())
      fault_ = path_ + ", [" + group_ + "] " + key + ": " + why;
  }

  bool has(const char *key) const
  {
    return g_key_file_has_key(file_, group_.c_str(), key, nullptr);
  }

  std::string string(const char *key) const
  {
    g_autofree gchar *value = g_key_file_get_string(file_, group_.c_str(), key, nullptr);
    return value ? value : "";
  }

  /// All numbers of a key, each in [least, most].
  std::vector<double> numbers(const char *key, double least, double most) const
  {
    g_autoptr(GError) error = nullptr;
    gsize count = 0;
    g_autofree gdouble *values
        = g_key_file_get_double_list(file_, group_.c_str(), key, &count, &error);
    if (error) {
      fail(key, std::string("expected numbers: ") + error->message);
      return {};
    }
    const std::span<const double> all(values, count);
    const auto wrong = std::ranges::find_if_not(
        all, [&](double value) { return value >= least && value <= most; });
    if (wrong != all.end()) {
      fail(key, "expected " + text(least) + " to " + text(most) + ", got " + text(*wrong));
      return {};
    }
    return { all.begin(), all.end() };
  }

  double number(const char *key, double least, double most) const
  {
    const std::vector<double> values = numbers(key, least, most);
    if (values.size() == 1)
      return values.front();
    fail(key, "expected one number, got " + std::to_string(values.size()));
    return least;
  }

private:
  GKeyFile *file_;
  std::string path_;
  std::string group_;
  std::string &fault_;
};

void
read_table(const Reader &in, TactorCalibration &tactor)
{
  RiseTimeTable table{ .step_volts = in.number("rise-table-step-volts", 0.001, kMostVolts),
                       .milliseconds = in.numbers("rise-table-ms", 0, kLongestMs) };
  table.size
      = static_cast<int>(std::lround(std::sqrt(static_cast<double>(table.milliseconds.size()))));
  if (const std::string fault = fault_of(table); !fault.empty())
    return in.fail("rise-table-ms", fault);
  tactor.table = std::move(table);
}

void
read_quadratic(const Reader &in, TactorCalibration &tactor)
{
  QuadraticRiseTime quadratic;
  const auto six = [&](const char *key, std::array<double, 6> &into) {
    const std::vector<double> values = in.numbers(key, -1e6, 1e6);
    if (values.size() != into.size())
      return in.fail(key, "expected six numbers, got " + std::to_string(values.size()));
    std::ranges::copy(values, into.begin());
  };
  six("rise-quadratic-ms", quadratic.coefficients);
  if (in.has("rise-quadratic-confidence-ms"))
    six("rise-quadratic-confidence-ms", quadratic.confidence);
  if (in.has("rise-quadratic-r-squared"))
    quadratic.r_squared = in.number("rise-quadratic-r-squared", -1e6, 1);
  if (in.has("rise-quadratic-residual-ms"))
    quadratic.residual_ms = in.number("rise-quadratic-residual-ms", 0, kLongestMs);
  tactor.quadratic = quadratic;
}

void
read_vibration(const Reader &in, TactorCalibration &tactor)
{
  const std::vector<double> volts = in.numbers("vibration-volts", 0, kMostVolts);
  const std::vector<double> amplitudes = in.numbers("vibration", 0, 1e12);
  if (volts.size() != amplitudes.size())
    return in.fail("vibration", "expected " + std::to_string(volts.size())
                                    + " amplitudes, one for each of vibration-volts, got "
                                    + std::to_string(amplitudes.size()));
  for (std::size_t i = 0; i < volts.size(); i++) {
    const VibrationPoint before = i > 0 ? tactor.vibration.back() : VibrationPoint{};
    if (!(volts[i] > before.volts) || amplitudes[i] < before.amplitude)
      return in.fail("vibration", "expected rising volts and amplitudes from above 0 V on, got "
                                      + text(amplitudes[i]) + " at " + text(volts[i]) + " V after "
                                      + text(before.amplitude) + " at " + text(before.volts)
                                      + " V");
    tactor.vibration.push_back({ volts[i], amplitudes[i] });
  }
  if (!tactor.vibration.empty() && tactor.vibration.back().amplitude <= 0)
    in.fail("vibration", "expected a motor that vibrates");
}

void
read_equalizer(const Reader &in, TactorCalibration &tactor)
{
  using synth::EqualizerBand;
  const std::vector<double> frequencies = in.numbers("equalizer-hz", 1, synth::kHighest);
  const std::vector<double> gains
      = in.numbers("equalizer-db", -EqualizerBand::kMostGain, EqualizerBand::kMostGain);
  const std::vector<double> qs
      = in.numbers("equalizer-q", EqualizerBand::kLeastQ, EqualizerBand::kMostQ);
  if (frequencies.size() > kMostBands)
    return in.fail("equalizer-hz", "expected at most " + std::to_string(kMostBands)
                                       + " numbers, got " + std::to_string(frequencies.size()));
  const auto is_short = [&](const char *key, const std::vector<double> &values) {
    if (values.size() != frequencies.size())
      in.fail(key, "expected as many numbers as equalizer-hz has, "
                       + std::to_string(frequencies.size()) + ", got "
                       + std::to_string(values.size()));
    return values.size() != frequencies.size();
  };
  if (is_short("equalizer-db", gains) || is_short("equalizer-q", qs))
    return;
  for (std::size_t i = 0; i < frequencies.size(); i++)
    tactor.equalizer.push_back({ .frequency = frequencies[i], .gain = gains[i], .q = qs[i] });
}

TactorCalibration
read_tactor(const Reader &in)
{
  TactorCalibration tactor;
  const auto volts = [&](const char *key, double unset) {
    return in.has(key) ? in.number(key, 0, kMostVolts) : unset;
  };
  if (in.has("latency-ms"))
    tactor.latency = from_ms(in.number("latency-ms", 0, 1000));
  tactor.start_volts = volts("start-volts", kStartVolts);
  tactor.hold_volts = volts("hold-volts", tactor.start_volts);
  if (tactor.hold_volts > tactor.start_volts)
    in.fail("hold-volts", "expected no more than start-volts, " + text(tactor.start_volts)
                              + ", got " + text(tactor.hold_volts));
  if (in.has("fall-ms"))
    tactor.fall_time = from_ms(in.number("fall-ms", 0.1, kLongestMs));
  if (in.has("rise-table-ms"))
    read_table(in, tactor);
  if (in.has("rise-quadratic-ms"))
    read_quadratic(in, tactor);
  const std::string model = in.string("rise-model");
  if (!model.empty() && model != "table" && model != "quadratic")
    in.fail("rise-model", "expected table or quadratic, got '" + model + "'");
  tactor.prefers_quadratic = model == "quadratic";
  if (in.has("vibration"))
    read_vibration(in, tactor);
  if (in.has("gain-db"))
    tactor.gain_db = in.number("gain-db", kLeastGain, kMostGain);
  for (const char *key : { "equalizer-hz", "equalizer-db", "equalizer-q" })
    if (in.has(key)) {
      read_equalizer(in, tactor);
      break;
    }
  const auto count = [&](const char *key) {
    return in.has(key) ? static_cast<int>(in.number(key, 0, 1e9)) : 0;
  };
  tactor.steps_used = count("steps-used");
  tactor.steps_refused = count("steps-refused");
  return tactor;
}

void
write_tactor(GKeyFile *file, int index, const TactorCalibration &tactor)
{
  const std::string group = kTactorGroup + std::to_string(index);
  const auto set = [&](const char *key, const std::string &value) {
    g_key_file_set_value(file, group.c_str(), key, value.c_str());
  };
  if (tactor.latency)
    set("latency-ms", text(to_ms(*tactor.latency)));
  set("start-volts", text(tactor.start_volts));
  set("hold-volts", text(tactor.hold_volts));
  set("fall-ms", text(to_ms(tactor.fall_time)));
  set("steps-used", std::to_string(tactor.steps_used));
  set("steps-refused", std::to_string(tactor.steps_refused));
  if (tactor.quadratic || tactor.table)
    set("rise-model", tactor.prefers_quadratic ? "quadratic" : "table");
  if (tactor.quadratic) {
    set("rise-quadratic-ms", text(tactor.quadratic->coefficients));
    set("rise-quadratic-confidence-ms", text(tactor.quadratic->confidence));
    set("rise-quadratic-r-squared", text(tactor.quadratic->r_squared));
    set("rise-quadratic-residual-ms", text(tactor.quadratic->residual_ms));
  }
  if (tactor.table) {
    set("rise-table-step-volts", text(tactor.table->step_volts));
    set("rise-table-ms", text(tactor.table->milliseconds));
  }
  std::vector<double> volts;
  std::vector<double> amplitudes;
  for (const VibrationPoint &point : tactor.vibration) {
    volts.push_back(point.volts);
    amplitudes.push_back(point.amplitude);
  }
  if (!volts.empty()) {
    set("vibration-volts", text(volts));
    set("vibration", text(amplitudes));
  }
  if (tactor.gain_db != 0)
    set("gain-db", text(tactor.gain_db));
  std::vector<double> frequencies;
  std::vector<double> gains;
  std::vector<double> qs;
  for (const synth::EqualizerBand &band : tactor.equalizer) {
    frequencies.push_back(band.frequency);
    gains.push_back(band.gain);
    qs.push_back(band.q);
  }
  if (!frequencies.empty()) {
    set("equalizer-hz", text(frequencies));
    set("equalizer-db", text(gains));
    set("equalizer-q", text(qs));
  }
}

} // namespace

tl::expected<Calibration, std::string>
read_calibration(const std::string &path)
{
  const KeyFile file(g_key_file_new());
  g_autoptr(GError) error = nullptr;
  const auto refused = [&path](const std::string &why) {
    return Error("cannot read the calibration '" + path + "': " + why);
  };
  const tl::expected<std::string, std::string> data = contents(path);
  if (!data)
    return refused(data.error());
  if (!g_key_file_load_from_data(file.get(), data->c_str(), data->size(), G_KEY_FILE_NONE, &error))
    return refused(error->message);

  std::string fault;
  const Reader head(file.get(), path, kGroup, fault);
  if (!head.has("version"))
    head.fail("version", "expected a calibration of version 1, found no version");
  if (const double version = head.number("version", 0, 1e6); version != Calibration::kVersion)
    head.fail("version",
              "expected 1, got " + text(version) + "; is this program older than the file?");
  Calibration calibration{ .motor = head.string("motor"),
                           .date = head.string("date"),
                           .method = head.string("method") };
  if (head.has("perception-exponent"))
    calibration.perception_exponent = head.number("perception-exponent", 0.1, 10);

  g_auto(GStrv) groups = g_key_file_get_groups(file.get(), nullptr);
  for (gchar **group = groups; *group && fault.empty(); group++) {
    if (!g_str_has_prefix(*group, kTactorGroup))
      continue;
    const Reader in(file.get(), path, *group, fault);
    const std::string name = *group + std::string_view(kTactorGroup).size();
    const int index = visuotactile::read_number<int>(name).value_or(-1);
    if (index >= 0 && index < kMostTactors)
      calibration.tactors[index] = read_tactor(in);
    else
      in.fail("", "expected a tactor's index, 0 to " + std::to_string(kMostTactors - 1));
  }
  if (calibration.tactors.empty())
    head.fail("", "expected at least one group [Tactor N]");
  if (!fault.empty())
    return Error(fault);
  return calibration;
}

tl::expected<void, std::string>
write_calibration(const Calibration &calibration, const std::string &path)
{
  const KeyFile file(g_key_file_new());
  g_key_file_set_comment(
      file.get(), nullptr, nullptr,
      " Vibration motors as measured; docs/guide/calibration.md explains the keys.", nullptr);
  g_key_file_set_integer(file.get(), kGroup, "version", Calibration::kVersion);
  g_key_file_set_string(file.get(), kGroup, "motor", calibration.motor.c_str());
  g_key_file_set_string(file.get(), kGroup, "date", calibration.date.c_str());
  g_key_file_set_string(file.get(), kGroup, "method", calibration.method.c_str());
  g_key_file_set_value(file.get(), kGroup, "perception-exponent",
                       text(calibration.perception_exponent).c_str());
  for (const auto &[index, tactor] : calibration.tactors)
    write_tactor(file.get(), index, tactor);
  g_autoptr(GError) error = nullptr;
  if (!g_key_file_save_to_file(file.get(), path.c_str(), &error))
    return Error("cannot write the calibration '" + path + "': " + error->message);
  return {};
}

} // namespace tactor
