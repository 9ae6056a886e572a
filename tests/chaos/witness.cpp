// SPDX-License-Identifier: LGPL-2.1-or-later
#include "witness.h"

#include "tactor/drivers/auto_driver.h"
#include "tactor/drivers/firmata_driver.h"
#include "tactor/drivers/registry.h"
#include "tactor/simulator.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <unistd.h>

using tactor::Time;

namespace {

/// The longest lead, plus the transport time of a Mega's 15 tactors, plus rounding.
constexpr gint64 kLead = 180 * GST_MSECOND + 50 * GST_MSECOND;
constexpr gint64 kHold = GST_SECOND; ///< see tactorsink
constexpr std::size_t kKeptMaps = 4000;
constexpr double kFullScale = 3.0;

/// A driver that reports to the witness.
class WitnessedDriver final : public tactor::Driver
{
public:
  explicit WitnessedDriver(std::unique_ptr<tactor::Driver> driver) : driver_(std::move(driver))
  {
  }
  ~WitnessedDriver() override
  {
    close();
  }
  tl::expected<void, tactor::DriverError> open(const tactor::DriverConfig &config) override
  {
    tl::expected<void, tactor::DriverError> opened = driver_->open(config);
    if (opened) {
      is_open_ = true;
      witness().opened();
    }
    return opened;
  }
  int tactors() const override
  {
    return driver_->tactors();
  }
  double resolution() const override
  {
    return driver_->resolution();
  }
  Time transport_latency() const override
  {
    return driver_->transport_latency();
  }
  tactor::LineTime line() const override
  {
    return driver_->line();
  }
  Time refresh_interval() const override
  {
    return driver_->refresh_interval();
  }
  tl::expected<void, tactor::DriverError> write(std::span<const double> volts, Time now) override
  {
    tl::expected<void, tactor::DriverError> written = driver_->write(volts, now);
    if (written)
      witness().wrote(volts, now);
    return written;
  }
  void close() noexcept override
  {
    driver_->close();
    if (std::exchange(is_open_, false))
      witness().closed();
  }
  tactor::DriverStatus status() const override
  {
    return driver_->status();
  }

private:
  std::unique_ptr<tactor::Driver> driver_;
  bool is_open_ = false;
};

/// Where the boards are remembered, for the life of this process.
struct KnownFile
{
  ~KnownFile()
  {
    std::filesystem::remove(path);
  }
  const std::filesystem::path path
      = std::filesystem::temp_directory_path() / ("chaos-boards-" + std::to_string(getpid()));
};

std::unique_ptr<tactor::Driver>
make_board(tactor::FirmataDriver::Firmware firmware)
{
  static const KnownFile known;
  tactor::FirmataDriver::Settings settings;
  settings.known_boards = known.path;
  // Also after a play in which they did not answer.
  for (const MemoryBoard *board : { &witness().mega, &witness().seat })
    tactor::KnownBoards(known.path).add(board->device);
  // Boards in memory answer immediately.
  settings.patience.answer = std::chrono::seconds(2);
  settings.look_again = std::chrono::milliseconds(200);
  return std::make_unique<tactor::FirmataDriver>(
      firmware, [] { return std::make_unique<MemoryBus>(witness().sockets); }, settings);
}

std::unique_ptr<tactor::Driver>
witnessed(std::unique_ptr<tactor::Driver> driver)
{
  return std::make_unique<WitnessedDriver>(std::move(driver));
}

// The original functions of the sink and its pad, the same for all tactorsinks.
GstFlowReturn (*render)(GstBaseSink *, GstBuffer *) = nullptr;
GstPadEventFunction event = nullptr;

GstFlowReturn
watched_render(GstBaseSink *sink, GstBuffer *buffer)
{
  witness().arrived(sink, buffer);
  return render(sink, buffer);
}

gboolean
watched_event(GstPad *pad, GstObject *parent, GstEvent *received)
{
  const GstEventType type = GST_EVENT_TYPE(received);
  if (type == GST_EVENT_CAPS) {
    GstCaps *caps = nullptr;
    gst_event_parse_caps(received, &caps);
    witness().took_caps(caps);
  }
  const gboolean handled = event(pad, parent, received);
  if (type == GST_EVENT_FLUSH_START)
    witness().flushed();
  return handled;
}

} // namespace

namespace tactor {

const std::vector<DriverInfo> &
drivers()
{
  using Firmware = FirmataDriver::Firmware;
  static const std::vector<DriverInfo> all{
    { "auto", "",
      [] {
        return witnessed(
            std::make_unique<AutoDriver>(make_board(Firmware::any), std::make_unique<Simulator>()));
      } },
    { "firmata", "",
      [] {
        return witnessed(make_board(Firmware::any));
      } },
    { "seat", "",
      [] {
        return witnessed(make_board(Firmware::with_watchdog));
      } },
    { "simulator", "",
      [] {
        return witnessed(std::make_unique<Simulator>());
      } },
  };
  return all;
}

tl::expected<std::unique_ptr<Driver>, DriverError>
make_driver(std::string_view name)
{
  const auto driver = std::ranges::find(drivers(), name, &DriverInfo::name);
  if (driver == drivers().end())
    return tl::unexpected(
        DriverError{ DriverError::Kind::not_found, "no driver \"" + std::string(name) + "\"" });
  return driver->create();
}

tl::expected<std::unique_ptr<SerialBus>, DriverError>
make_serial_bus()
{
  return std::make_unique<MemoryBus>(witness().sockets);
}

} // namespace tactor

Witness &
witness()
{
  static Witness the;
  return the;
}

void
Witness::watch(GstElement *tactors)
{
  GstBaseSinkClass *klass = GST_BASE_SINK_GET_CLASS(tactors);
  if (klass->render != watched_render) {
    render = klass->render;
    klass->render = watched_render;
  }
  GstPad *pad = gst_element_get_static_pad(tactors, "sink");
  if (GST_PAD_EVENTFUNC(pad) != watched_event) {
    event = GST_PAD_EVENTFUNC(pad);
    gst_pad_set_event_function(pad, watched_event);
  }
  gst_object_unref(pad);
}

void
Witness::set_mappings(std::vector<std::vector<int>> mappings)
{
  std::lock_guard lock(mutex_);
  mappings_ = std::move(mappings);
}

bool
Witness::is_asked_for(const Map &map, std::size_t tactor) const
{
  if (tactor < map.on.size() && map.on[tactor])
    return true;
  for (const std::vector<int> &mapping : mappings_)
    for (std::size_t cell = 0; cell < std::min(mapping.size(), map.on.size()); cell++)
      if (map.on[cell] && mapping[cell] == static_cast<int>(tactor))
        return true;
  return false;
}

void
Witness::opened()
{
  std::lock_guard lock(mutex_);
  if (is_open_)
    accuse("a second driver was opened while one is open");
  is_open_ = true;
  volts_.clear();
  maps_.clear();
  latest_ = kNever;
}

void
Witness::closed()
{
  std::lock_guard lock(mutex_);
  is_open_ = false;
  volts_.clear();
}

void
Witness::wrote(std::span<const double> volts, Time now)
{
  std::lock_guard lock(mutex_);
  if (!is_open_)
    accuse("a driver that is closed was written to");
  volts_.assign(volts.begin(), volts.end());
  write_count_++;
  // A growing latency sets running time back. What has started continues.
  latest_ = std::max(latest_, now.count());
  bool any = false;
  for (std::size_t i = 0; i < volts_.size(); i++) {
    if (volts_[i] == 0)
      continue;
    any = true;
    if (!(volts_[i] > 0 && volts_[i] <= kFullScale))
      accuse("tactor " + std::to_string(i) + " was told " + std::to_string(volts_[i]) + " V");
    const bool wanted = std::ranges::any_of(maps_, [&](const Map &map) {
      return is_asked_for(map, i) && map.start - kLead <= latest_;
    });
    if (!wanted)
      accuse("tactor " + std::to_string(i) + " was told " + std::to_string(volts_[i])
             + " V at running time " + std::to_string(now.count()) + " ns; none of "
             + std::to_string(maps_.size()) + " maps since the last flush asks for it by then");
  }
  vibration_count_ += any;
}

void
Witness::arrived(GstBaseSink *sink, GstBuffer *buffer)
{
  gsize cells = 0;
  {
    std::lock_guard lock(mutex_);
    cells = cells_;
  }
  std::vector<gfloat> levels;
  if (const GstTactileMeta *meta = gst_buffer_get_tactile_meta(buffer)) {
    levels.assign(meta->levels, meta->levels + static_cast<gsize>(meta->rows) * meta->columns);
  } else {
    levels.resize(cells);
    levels.resize(gst_buffer_extract(buffer, 0, levels.data(), cells * sizeof levels[0])
                  / sizeof levels[0]);
  }
  GST_OBJECT_LOCK(sink);
  const GstSegment segment = sink->segment; // changed by steps
  GST_OBJECT_UNLOCK(sink);
  const GstClockTime duration
      = GST_BUFFER_DURATION_IS_VALID(buffer) ? GST_BUFFER_DURATION(buffer) : GST_SECOND / 10;
  guint64 from = GST_BUFFER_PTS(buffer);
  guint64 to = from + duration;
  Map map{ std::numeric_limits<gint64>::min(), std::numeric_limits<gint64>::max(), {} };
  if (GST_BUFFER_PTS_IS_VALID(buffer)
      && gst_segment_clip(&segment, GST_FORMAT_TIME, from, to, &from, &to)) {
    if (segment.rate < 0)
      std::swap(from, to);
    map.start = static_cast<gint64>(gst_segment_to_running_time(&segment, GST_FORMAT_TIME, from));
    // The whole frame: the clipped one may be shorter than the hold.
    map.end
        = map.start + static_cast<gint64>(static_cast<double>(duration) / std::abs(segment.rate));
  }
  for (const gfloat level : levels)
    map.on.push_back(level > 0);
  std::lock_guard lock(mutex_);
  map_count_++;
  maps_.push_back(std::move(map));
  if (maps_.size() > kKeptMaps)
    maps_.pop_front();
}

void
Witness::flushed()
{
  expect_silence("after a flush");
  std::lock_guard lock(mutex_);
  flush_count_++;
  maps_.clear();
  latest_ = kNever;
}

void
Witness::took_caps(const GstCaps *caps)
{
  gint rows = 0;
  gint columns = 0;
  const GstStructure *structure = gst_caps_get_structure(caps, 0);
  if (!gst_structure_get_int(structure, "rows", &rows)
      || !gst_structure_get_int(structure, "columns", &columns))
    return;
  std::lock_guard lock(mutex_);
  cells_ = static_cast<gsize>(rows) * static_cast<gsize>(columns);
}

void
Witness::expect_silence(const std::string &when)
{
  std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < volts_.size(); i++)
    if (volts_[i] != 0)
      accuse(when + ": tactor " + std::to_string(i) + " is at " + std::to_string(volts_[i]) + " V");
}

bool
Witness::agrees_with_film(gint64 running, std::string &reason)
{
  std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < volts_.size(); i++) {
    const bool wanted = volts_[i] == 0 || std::ranges::any_of(maps_, [&](const Map &map) {
                          return is_asked_for(map, i)
                                 && map.start - kLead <= std::max(running, latest_)
                                 && (map.end > running - kHold - kLead);
                        });
    if (wanted)
      continue;
    reason = "tactor " + std::to_string(i) + " is at " + std::to_string(volts_[i])
             + " V at running time " + std::to_string(running) + " ns; the film asks for it";
    for (const Map &map : maps_)
      if (is_asked_for(map, i))
        reason += " [" + std::to_string(map.start) + ", " + std::to_string(map.end) + ")";
    return false;
  }
  return true;
}

bool
Witness::boards_agree(std::string &reason)
{
  std::vector<double> volts;
  {
    std::lock_guard lock(mutex_);
    volts = volts_;
  }
  std::lock_guard lock(sockets.mutex);
  for (const MemoryBoard *board : { &mega, &seat }) {
    if (board->model.is_silent() || board->takes_nothing)
      continue;
    std::size_t tactor = 0;
    for (const int pin : kMega.pwm) {
      const double told = tactor < volts.size() ? volts[tactor] : 0;
      tactor++;
      const auto duty = board->model.duty.find(pin);
      const int has = duty == board->model.duty.end() ? 0 : duty->second;
      if (has == static_cast<int>(std::lround(told / kFullScale * 255)))
        continue;
      reason = board->device.name + "'s pin " + std::to_string(pin) + " has " + std::to_string(has)
               + " of 255, the driver was told " + std::to_string(told) + " V";
      return false;
    }
  }
  return true;
}

guint64
Witness::maps() const
{
  std::lock_guard lock(mutex_);
  return map_count_;
}

guint64
Witness::writes() const
{
  std::lock_guard lock(mutex_);
  return write_count_;
}

guint64
Witness::vibrations() const
{
  std::lock_guard lock(mutex_);
  return vibration_count_;
}

guint64
Witness::flushes() const
{
  std::lock_guard lock(mutex_);
  return flush_count_;
}
