// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Elements that make maps agree with tactorsink on its device's grid. Devices are those of a server
// (support/haptic_server.py).
#include "support/haptic_server.h"

#include "support/playing.h"

#include <gst/tactile/tactile.h>

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "support/check_tests.h"

namespace {

using Grid = std::pair<guint, guint>;

constexpr Grid kDefault{ 3, 3 };
constexpr Grid kVest{ 5, 4 };
constexpr Grid kSleeve{ 2, 3 };
constexpr Grid kVisor{ 1, 6 };

/// A pipeline with a tactorsink on a device of the server, and the grids of the maps that come to
/// it.
class Play
{
public:
  /// `line` ends where tactorsink's pad is linked.
  Play(const std::string &line, const std::string &device)
      : pipeline_(make_pipeline(line + " ! tactorsink name=tactors sync=false driver=bhaptics"))
  {
    begin(device);
  }
  /// `line` has another tactorsink, `name=other`, for a device of the same server.
  Play(const std::string &line, const std::string &other, const std::string &device)
      : Play(line, device)
  {
    g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline_), "other");
    g_object_set(sink, "driver", "bhaptics", "device", server_.device(other).c_str(), nullptr);
  }
  /// `line` has a visuotactilesink, `name=chair`.
  explicit Play(const std::string &line) : pipeline_(make_pipeline(line))
  {
    begin("vest");
  }
  ~Play()
  {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
    g_autoptr(GstMessage) error = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    fail_unless(error == nullptr, "%s", error ? Said(error).details.c_str() : "");
    gst_object_unref(pad_);
    gst_object_unref(tactors_);
    gst_object_unref(pipeline_);
  }
  Play(const Play &) = delete;
  Play &operator=(const Play &) = delete;

  /// Plays until maps of this grid come.
  void expect(const Grid &grid)
  {
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return last_ == grid; });
  }
  /// Waits until motors at these positions have been on from now on.
  void expect_motors(const std::vector<std::string> &positions)
  {
    for (const std::string &position : positions)
      server_.wait_for("motors " + position + " ");
  }
  Grid last()
  {
    const std::lock_guard lock(mutex_);
    return last_;
  }
  /// Plays to the end. Returns the grids of all maps.
  std::set<Grid> play()
  {
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
    wait_for_eos(pipeline_);
    const std::lock_guard lock(mutex_);
    return all_;
  }
  void change_device(const std::string &device)
  {
    gst_element_set_state(pipeline_, GST_STATE_READY);
    use(device);
    const std::lock_guard lock(mutex_);
    last_ = {};
  }
  void use_simulator()
  {
    gst_element_set_state(pipeline_, GST_STATE_READY);
    g_object_set(tactors_, "driver", "simulator", "device", "", nullptr);
  }

private:
  void begin(const std::string &device)
  {
    tactors_ = gst_bin_get_by_name(GST_BIN(pipeline_), "tactors");
    pad_ = gst_element_get_static_pad(tactors_, "sink");
    gst_pad_add_probe(pad_, GST_PAD_PROBE_TYPE_BUFFER, came, this, nullptr);
    use(device);
  }
  void use(const std::string &device)
  {
    g_object_set(tactors_, "driver", "bhaptics", "device", server_.device(device).c_str(), nullptr);
  }

  static GstPadProbeReturn came(GstPad *pad, GstPadProbeInfo *info, gpointer user_data)
  {
    Grid grid;
    g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
    const GstTactileMeta *meta = gst_buffer_get_tactile_meta(GST_PAD_PROBE_INFO_BUFFER(info));
    if (meta)
      grid = { meta->rows, meta->columns };
    else
      gst_tactile_map_caps_parse(caps, &grid.first, &grid.second, nullptr, nullptr);
    auto *self = static_cast<Play *>(user_data);
    const std::lock_guard lock(self->mutex_);
    self->last_ = grid;
    self->all_.insert(grid);
    self->changed_.notify_all();
    return GST_PAD_PROBE_OK;
  }

  HapticServer server_{ { "bhaptics" } };
  GstElement *pipeline_;
  GstElement *tactors_ = nullptr;
  GstPad *pad_ = nullptr;
  std::mutex mutex_; ///< guards everything below
  std::condition_variable changed_;
  Grid last_;
  std::set<Grid> all_;
};

const std::string kFilm = "tactiletestsrc ! video/x-raw,width=64,height=64 ! saliencytactile ";

} // namespace

/// The device's grid comes first, and any other is taken.
CHECK_TEST(test_caps)
{
  HapticServer server({ "bhaptics" });
  g_autoptr(GstElement) sink
      = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
  g_autoptr(GstPad) pad = gst_element_get_static_pad(sink, "sink");
  g_autoptr(GstCaps) maps = gst_caps_from_string("application/x-tactile-map");
  for (const auto &[device, rows, columns] :
       { std::tuple{ "vest", 5, 4 }, std::tuple{ "sleeve-left", 2, 3 } }) {
    g_object_set(sink, "driver", "bhaptics", "device", server.device(device).c_str(), "async",
                 FALSE, nullptr);
    change_state(sink, GST_STATE_PAUSED);
    fail_unless(gst_pad_send_event(pad, gst_event_new_stream_start("film"))); // it is open
    g_autoptr(GstCaps) caps = gst_pad_query_caps(pad, maps);
    ck_assert_uint_eq(gst_caps_get_size(caps), 2);
    const GstStructure *first = gst_caps_get_structure(caps, 0);
    gint value = 0;
    fail_unless(gst_structure_get_int(first, "rows", &value));
    ck_assert_int_eq(value, rows);
    fail_unless(gst_structure_get_int(first, "columns", &value));
    ck_assert_int_eq(value, columns);
    g_autoptr(GstCaps) other = gst_tactile_map_caps_new(64, 1, 25, 1);
    fail_unless(gst_pad_query_accept_caps(pad, other));
    g_autoptr(GstCaps) film = gst_caps_from_string("video/x-raw,format=GRAY8,width=8,height=8,"
                                                   "framerate=25/1");
    fail_unless(gst_pad_query_accept_caps(pad, film));
    gst_element_set_state(sink, GST_STATE_READY);
  }
  gst_element_set_state(sink, GST_STATE_NULL);
}

CHECK_TEST(test_agreed)
{
  Play(kFilm, "vest").expect(kVest);
  Play(kFilm + "! queue", "sleeve-left").expect(kSleeve);
  Play(kFilm + "! tactileextractor name=x x.src ! fakesink x.tactile ! queue", "vest")
      .expect(kVest);
  Play("tactilesoundtestsrc ! soundtactile name=s s.src ! fakesink s.tactile ! queue", "visor")
      .expect(kVisor);
}

CHECK_TEST(test_in_a_player)
{
  Play("tactiletestsrc ! video/x-raw,width=64,height=64 ! visuotactilesink video-sink=fakesink")
      .expect(kVest);
}

/// Of two devices at a tee, the first one has maps of its grid, and the other one pools them.
CHECK_TEST(test_two_devices)
{
  for (const std::string &maps :
       { kFilm, kFilm + "! tactileextractor name=x x.src ! fakesink x.tactile " })
    for (const auto &[first, second, grid] : { std::tuple{ "vest-back", "visor", kVest },
                                               std::tuple{ "visor", "vest-back", kVisor } }) {
      Play film(maps + "! tee name=t t. ! queue ! tactorsink name=other sync=false t. ! queue",
                first, second);
      film.expect(grid);
      film.expect_motors({ "VestBack", "Head" }); // both are open
      film.expect(grid);
      film.expect_motors({ "VestBack", "Head" });
      fail_unless(film.last() == grid);
    }
}

/// What the user sets is not asked.
CHECK_TEST(test_set_by_the_user)
{
  const std::string film = "tactiletestsrc num-buffers=20 ! video/x-raw,width=64,height=64 ! "
                           "saliencytactile ";
  for (const auto &[grid, expected] :
       { std::pair{ "rows=3 columns=3", kDefault }, std::pair{ "columns=2", Grid{ 3, 2 } } }) {
    Play film_of_the_user(film + grid + " ! queue", "vest");
    fail_unless(film_of_the_user.play() == std::set<Grid>{ expected });
  }
}

/// Each play agrees anew. A device without places has no grid.
CHECK_TEST(test_device_changes)
{
  Play film(kFilm + "! tactileextractor name=x x.src ! fakesink x.tactile ! queue", "vest");
  film.expect(kVest);
  film.change_device("visor");
  film.expect(kVisor);
  film.use_simulator();
  film.expect(kDefault);
}

CHECK_MAIN(tactorsink_grid)
