// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink with real drivers and boards in memory. The element is linked into this program, which
// provides the serial bus.
#include "gst/tactor/gsttactorsink.h"

#include "support/boards/known_home.h"
#include "support/boards/memory_bus.h"

#include "tactor/command_trace.h"

#include <cmath>
#include <string>

#include "support/contains.h"
#include "support/no_threads.h"
#include "support/playing.h"
#include "support/temporary_file.h"
#include "support/unwrap.h"
#include <gst/check/gsttestclock.h>
#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

using tactor::SerialDevice;
using Duties = std::vector<int>; ///< 0…255, of 8-bit pins

static Sockets *sockets; ///< of the running test

tl::expected<std::unique_ptr<tactor::SerialBus>, tactor::DriverError>
tactor::make_serial_bus()
{
  return std::make_unique<MemoryBus>(*sockets);
}

namespace {

SerialDevice
device(const char *serial, const char *name)
{
  return {
    .serial = serial, .bus_path = std::string("1-") + serial, .name = name, .transport = ""
  };
}

GstElement *
make_tactorsink()
{
  GST_ELEMENT_REGISTER(tactorsink, nullptr);
  return GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
}

/// A sink that does not wait for the clock: when push() returns, the driver has the map.
class BoardRig
{
public:
  explicit BoardRig(const char *driver = nullptr)
  {
    sockets = &sockets_;
    g_object_set(element, "sync", FALSE, "async", FALSE, "rate", 0.0, "compensation", 2,
                 "max-on-time", guint64{ 0 }, "max-duty", 0.0, "max-active", 0u, nullptr);
    if (driver)
      g_object_set(element, "driver", driver, nullptr);
    pad = gst_element_get_static_pad(element, "sink");
  }
  ~BoardRig()
  {
    stop();
    gst_object_unref(pad);
    gst_object_unref(element);
  }

  /// False if the board cannot be opened.
  bool start()
  {
    return gst_element_set_state(element, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE && begin();
  }
  /// Sends the events before the first map. False if there is no board or the sink is flushing.
  bool begin()
  {
    if (!gst_pad_send_event(pad, gst_event_new_stream_start("film")))
      return false;
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    GstCaps *caps = gst_caps_from_string(
        "application/x-tactile-map,rows=(int)1,columns=(int)3,framerate=(fraction)25/1");
    fail_unless(gst_pad_send_event(pad, gst_event_new_caps(caps)));
    fail_unless(gst_pad_send_event(pad, gst_event_new_segment(&segment)));
    gst_caps_unref(caps);
    return true;
  }
  void stop()
  {
    gst_element_set_state(element, GST_STATE_NULL);
  }
  /// Pushes a map whose levels are these duties.
  void push(const Duties &duties)
  {
    std::vector<gfloat> levels;
    for (const int duty : duties)
      levels.push_back(static_cast<gfloat>(duty) / 255.0f);
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = frame++ * 40 * GST_MSECOND;
    GST_BUFFER_DURATION(map) = length;
    ck_assert_int_eq(gst_pad_chain(pad, map), GST_FLOW_OK);
  }
  /// Waits until these pins of a board have these duties.
  void expect(MemoryBoard &board, const std::vector<int> &pins, const Duties &duties)
  {
    sockets_.wait([&] {
      for (std::size_t i = 0; i < pins.size(); i++)
        if (board.model.duty[pins[i]] != duties[i])
          return false;
      return true;
    });
  }
  /// The text of the next message of this type, or its name for an element message.
  std::string message(GstMessageType type, int *code = nullptr)
  {
    g_autoptr(GstMessage) message
        = gst_bus_timed_pop_filtered(messages.bus, GST_CLOCK_TIME_NONE, type);
    if (type == GST_MESSAGE_ELEMENT)
      return gst_structure_get_name(gst_message_get_structure(message));
    const Said said(message);
    if (code)
      *code = said.code;
    return said.text + said.details;
  }
  GstStructure *stats()
  {
    GstStructure *stats = nullptr;
    g_object_get(element, "actuation-stats", &stats, nullptr);
    return stats;
  }

  Sockets sockets_;
  MemoryBoard mega{ device("7573", "Arduino Mega 2560"), kMega };
  MemoryBoard uno{ device("95", "Arduino Uno"), kUno };
  const KnownHome home{ mega.device, uno.device };
  GstElement *element = make_tactorsink();
  ElementBus messages{ element };
  GstPad *pad;
  guint frame = 0;
  GstClockTime length = 40 * GST_MSECOND; ///< of a map
};

} // namespace

/// The default driver without a board: simulated, with a message.
CHECK_TEST(test_auto_without_board)
{
  BoardRig rig;
  fail_unless(rig.start());
  assert_contains(rig.message(GST_MESSAGE_INFO), { "simulated", "no tactor board" });
  fail_if(rig.messages.has(GST_MESSAGE_WARNING));
  rig.push({ 255, 0, 128 });
  GstStructure *stats = rig.stats();
  ck_assert_str_eq(gst_structure_get_string(stats, "board"), "simulator");
  gst_structure_free(stats);
}

/// The default driver with a board: a film plays on its motors, the board is reported, and motors
/// go to zero however it ends.
CHECK_TEST(test_auto_with_board)
{
  BoardRig rig;
  rig.sockets_.plug(rig.mega);
  fail_unless(rig.start());
  assert_contains(rig.message(GST_MESSAGE_INFO), { "Mega", "7573", "StandardFirmata" });
  assert_contains(rig.message(GST_MESSAGE_WARNING), { "no watchdog" });
  const std::vector<int> pins{ 2, 3, 4 };
  for (int i = 0; i < 50; i++) {
    const Duties duties{ 255 - i, 60 + i, i % 2 * 128 };
    rig.push(duties);
    rig.expect(rig.mega, pins, duties);
  }

  GstStructure *stats = rig.stats();
  assert_contains(gst_structure_get_string(stats, "board"), { "Mega", "7573" });
  ck_assert_str_eq(gst_structure_get_string(stats, "firmware"), "StandardFirmata.ino 2.5");
  gboolean connected = FALSE;
  gboolean watchdog = TRUE;
  guint64 bytes = 0;
  guint64 reconnects = 1;
  fail_unless(gst_structure_get(stats, "connected", G_TYPE_BOOLEAN, &connected, "watchdog",
                                G_TYPE_BOOLEAN, &watchdog, "bytes", G_TYPE_UINT64, &bytes,
                                "reconnects", G_TYPE_UINT64, &reconnects, nullptr));
  fail_unless(connected && !watchdog && reconnects == 0);
  ck_assert_uint_ge(bytes, 50 * 9);
  const GValue *array = gst_structure_get_value(stats, "pins");
  ck_assert_uint_eq(gst_value_array_get_size(array), 15);
  ck_assert_int_eq(g_value_get_int(gst_value_array_get_value(array, 14)), 46);
  gst_structure_free(stats);
  guint64 delay = 0;
  g_object_get(rig.element, "render-delay", &delay, nullptr);
  ck_assert_uint_eq(delay, 190 * GST_MSECOND + 9450 * GST_USECOND);

  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  rig.expect(rig.mega, pins, { 0, 0, 0 });
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.expect(rig.mega, pins, { 206, 109, 128 });
  g_object_set(rig.element, "mute", TRUE, nullptr);
  rig.expect(rig.mega, pins, { 0, 0, 0 });
  g_object_set(rig.element, "mute", FALSE, nullptr);
  rig.expect(rig.mega, pins, { 206, 109, 128 });
  rig.stop();
  fail_unless(rig.mega.model.is_silent());
  ck_assert_int_eq(rig.mega.model.received.back(), 0xf9);
  ck_assert_int_eq(*(rig.mega.model.received.end() - 2), 0xff);
  fail_if(rig.mega.is_open);
}

/// The film's time stands still while a motor is on: the limit is kept by the motor's. The next
/// play on the board has the account of this one.
CHECK_TEST(test_limits_are_of_the_motor)
{
  const std::vector<std::uint8_t> full{ 0xe2, 0x7f, 1 }; // pin 2, 255
  const auto count_full = [&](const BoardRig &rig) {
    int count = 0;
    const std::vector<std::uint8_t> &received = rig.mega.model.received;
    for (auto at = received.begin();
         (at = std::search(at, received.end(), full.begin(), full.end())) != received.end(); ++at)
      count++;
    return count;
  };
  for (int play = 0; play < 2; play++) {
    BoardRig rig("firmata");
    g_object_set(rig.element, "max-duty", 0.001, nullptr); // 60 ms a minute
    rig.sockets_.plug(rig.mega);
    fail_unless(rig.start());
    rig.push({ 255, 0, 0 });
    if (play == 0) {
      rig.sockets_.wait([&] { return count_full(rig) == 1 && rig.mega.model.duty[2] == 0; });
      ck_assert_uint_eq(actuation_stat_of(rig.element, "cut-driver"), 1);
    } else {
      ck_assert_uint_eq(actuation_stat_of(rig.element, "cut-duty"), 1);
      ck_assert_uint_eq(actuation_stat_of(rig.element, "issued"), 0);
    }
    rig.stop();
    ck_assert_int_eq(count_full(rig), play == 0 ? 1 : 0);
  }
}

CHECK_TEST(test_end_of_stream)
{
  BoardRig rig("firmata");
  rig.sockets_.plug(rig.mega);
  fail_unless(rig.start());
  rig.push({ 255, 255, 255 });
  fail_unless(gst_pad_send_event(rig.pad, gst_event_new_eos()));
  rig.sockets_.wait([&] { return rig.mega.model.is_silent(); });
}

/// A lost board causes one warning for users and a message for programs, and the film goes on. The
/// trace has zeros for it, and a board that returns resumes the current levels.
CHECK_TEST(test_lost_and_found)
{
  BoardRig rig("firmata");
  const TemporaryFile trace;
  g_object_set(rig.element, "trace-location", trace.path.c_str(), nullptr);
  rig.sockets_.plug(rig.mega);
  fail_unless(rig.start());
  rig.message(GST_MESSAGE_INFO);
  rig.message(GST_MESSAGE_WARNING);
  rig.push({ 255, 127, 128 });
  rig.expect(rig.mega, { 2, 3, 4 }, { 255, 127, 128 });
  rig.sockets_.unplug(rig.mega);
  assert_contains(rig.message(GST_MESSAGE_WARNING), { "gone", "7573", "plugged out" });
  assert_contains(rig.message(GST_MESSAGE_ELEMENT), { "tactor-device-lost" });
  for (int i = 0; i < 30; i++)
    rig.push({ 200, 100, 50 + i });
  GstStructure *stats = rig.stats();
  gboolean connected = TRUE;
  gst_structure_get_boolean(stats, "connected", &connected);
  fail_if(connected);
  gst_structure_free(stats);
  rig.sockets_.plug(rig.mega);
  assert_contains(rig.message(GST_MESSAGE_INFO), { "7573", "is back" });
  assert_contains(rig.message(GST_MESSAGE_ELEMENT), { "tactor-device-found" });
  rig.expect(rig.mega, { 2, 3, 4 }, { 200, 100, 79 });
  fail_if(rig.messages.has(GST_MESSAGE_WARNING));
  stats = rig.stats();
  guint64 reconnects = 0;
  gst_structure_get_uint64(stats, "reconnects", &reconnects);
  ck_assert_uint_eq(reconnects, 1);
  gst_structure_free(stats);
  rig.stop();
  fail_unless(rig.mega.model.is_silent());
  std::vector<long> told; // tactor 0
  for (const tactor::IssuedCommand &line : unwrap(tactor::read_command_trace(trace.path)))
    if (line.command.tactor == 0)
      told.push_back(std::lround(line.command.volts / 3.0 * 255));
  fail_unless(told == (std::vector<long>{ 255, 0, 200, 0 }));
}

/// A board that cannot be opened is an error with the reason and GStreamer's code for it.
CHECK_TEST(test_errors)
{
  const auto refused = [](BoardRig &rig) {
    fail_if(rig.start());
    rig.stop();
    int code = 0;
    const std::string text = rig.message(GST_MESSAGE_ERROR, &code);
    return std::pair(text, code);
  };
  BoardRig none("firmata");
  fail_unless(refused(none).second == GST_RESOURCE_ERROR_NOT_FOUND);
  {
    const NoThreads threads;
    assert_contains(refused(none).first, { "no thread" });
  }

  BoardRig stock("seat");
  stock.sockets_.plug(stock.mega);
  auto [text, code] = refused(stock);
  assert_contains(text, { "seat firmware", "driver=firmata" });
  ck_assert_int_eq(code, GST_RESOURCE_ERROR_SETTINGS);

  BoardRig small;
  small.sockets_.plug(small.uno);
  gst_util_set_object_arg(G_OBJECT(small.element), "mapping", "<0,-1,8>");
  std::tie(text, code) = refused(small);
  assert_contains(text, { "6 pins", "9 tactors", "mapping" });
  ck_assert_int_eq(code, GST_RESOURCE_ERROR_SETTINGS);
  gst_util_set_object_arg(G_OBJECT(small.element), "mapping", "<5,-1,0>");
  fail_unless(small.start());
  small.push({ 255, 200, 128 });
  small.expect(small.uno, { 11, 3, 5 }, { 255, 128, 0 });

  using Kind = tactor::DriverError::Kind;
  for (const auto &[kind, expected] :
       { std::pair(Kind::permission, GST_RESOURCE_ERROR_NOT_AUTHORIZED),
         std::pair(Kind::busy, GST_RESOURCE_ERROR_BUSY) }) {
    BoardRig rig("firmata");
    rig.mega.refusal = kind;
    rig.sockets_.plug(rig.mega);
    ck_assert_int_eq(refused(rig).second, expected);
  }
}

/// Pause, play and seek while the board does not answer: the stream keeps waiting or is flushed,
/// and plays once the board answers.
CHECK_TEST(test_slow_board)
{
  BoardRig rig("firmata");
  rig.mega.says_nothing = true;
  rig.sockets_.plug(rig.mega);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  bool began = true;
  std::thread streaming([&] { began = rig.begin(); });
  rig.sockets_.wait([&] { return rig.mega.opens == 1; });
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  fail_unless(gst_pad_send_event(rig.pad, gst_event_new_flush_start()));
  streaming.join();
  fail_if(began);
  fail_unless(gst_pad_send_event(rig.pad, gst_event_new_flush_stop(TRUE)));
  rig.sockets_.locked([&] { rig.mega.says_nothing = false; });
  fail_unless(rig.begin()); // the board is asked twice a second
  rig.push({ 255, 200, 128 });
  rig.expect(rig.mega, { 2, 3, 4 }, { 255, 200, 128 });
  fail_if(rig.messages.has(GST_MESSAGE_ERROR));
}

/// A live stream by a test clock, whose board is open at 10 s: until then, time passes.
class LiveRig : public BoardRig
{
public:
  LiveRig() : BoardRig("firmata")
  {
    mega.says_nothing = true;
    sockets_.plug(mega);
    g_object_set(element, "sync", TRUE, "ramp-in", guint64{ 0 }, nullptr);
    gst_pad_set_query_function(source_, [](GstPad *, GstObject *, GstQuery *query) -> gboolean {
      if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY)
        return FALSE;
      gst_query_set_latency(query, TRUE, 0, GST_CLOCK_TIME_NONE);
      return TRUE;
    });
    fail_unless(gst_pad_link(source_, pad) == GST_PAD_LINK_OK);
    gst_element_set_clock(element, clock);
    gst_element_set_base_time(element, 90 * GST_SECOND);
    gst_element_set_state(element, GST_STATE_PLAYING);
    sockets_.wait([&] { return mega.opens == 1; });
    sockets_.locked([&] { mega.says_nothing = false; });
    fail_unless(begin());
  }
  ~LiveRig()
  {
    stop();
    gst_pad_unlink(source_, pad);
    gst_object_unref(source_);
    gst_object_unref(clock);
  }
  LiveRig(const LiveRig &) = delete;
  LiveRig &operator=(const LiveRig &) = delete;

  void push(int shown_ms, const Duties &duties)
  {
    frame = static_cast<guint>(shown_ms / 40);
    std::thread streaming([&] { BoardRig::push(duties); });
    gst_test_clock_wait_for_next_pending_id(GST_TEST_CLOCK(clock), nullptr);
    gst_clock_id_unref(gst_test_clock_process_next_clock_id(GST_TEST_CLOCK(clock)));
    streaming.join();
  }

  GstClock *clock = gst_test_clock_new_with_start_time(100 * GST_SECOND);

private:
  GstPad *source_ = gst_pad_new("src", GST_PAD_SRC);
};

/// In a live stream time passes while the board is opened. Maps of that time are dropped and not
/// reported as late.
CHECK_TEST(test_slow_board_in_a_live_play)
{
  LiveRig rig;
  for (const int shown_ms : { 9000, 10000, 10040 })
    rig.push(shown_ms, { 255, 255, 255 });
  GstStructure *stats = rig.stats();
  guint64 late = 1;
  fail_unless(gst_structure_get_uint64(stats, "late", &late));
  ck_assert_uint_eq(late, 0);
  gst_structure_free(stats);
  fail_if(rig.messages.has(GST_MESSAGE_ELEMENT));
  // From then on it plays.
  gst_test_clock_set_time(GST_TEST_CLOCK(rig.clock), 102 * GST_SECOND);
  rig.push(12000, { 255, 200, 128 });
  rig.expect(rig.mega, { 2, 3, 4 }, { 255, 200, 128 });
}

/// A long map that began before the board was open, such as a cue, is felt from then on.
CHECK_TEST(test_long_map_in_a_live_play)
{
  LiveRig rig;
  rig.length = 2 * GST_SECOND;
  gst_test_clock_set_time(GST_TEST_CLOCK(rig.clock), 101 * GST_SECOND);
  rig.push(9600, { 255, 200, 128 });
  rig.expect(rig.mega, { 2, 3, 4 }, { 255, 200, 128 });
}

/// 64 tactors: 14 pins whose levels take 3 bytes, and 50 that take 6. If max-active lets few of
/// them change at once, there is an information. Otherwise there is a warning with figures and
/// advice, and a message for programs. With nine tactors there is neither.
CHECK_TEST(test_large_chair)
{
  Layout layout = kUno;
  layout.pins = 66;
  layout.pwm.clear();
  for (int pin = 2; pin < layout.pins; pin++)
    layout.pwm.insert(pin);
  const auto start = [&](guint max_active, const char *mapping = nullptr) {
    auto rig = std::make_unique<BoardRig>("seat");
    g_object_set(rig->element, "max-active", max_active, "rate", 5.0, nullptr);
    if (mapping)
      gst_util_set_object_arg(G_OBJECT(rig->element), "mapping", mapping);
    return rig;
  };
  MemoryBoard large{ device("64", "Large"), layout, true };
  {
    auto rig = start(4);
    rig->sockets_.plug(large);
    fail_unless(rig->start());
    rig->message(GST_MESSAGE_INFO); // about the board
    assert_contains(rig->message(GST_MESSAGE_INFO),
                    { "64 tactors", "342 bytes", "59.9 ms", "8.4 ms" });
    fail_if(rig->messages.has(GST_MESSAGE_WARNING));
    rig->sockets_.unplug(large);
  }
  {
    auto rig = start(0);
    rig->sockets_.plug(large);
    fail_unless(rig->start());
    assert_contains(rig->message(GST_MESSAGE_WARNING),
                    { "too large for its serial line", "64 tactors", "342 bytes", "59.9 ms",
                      "16.7 times", "max-active to 9" });
    g_autoptr(GstMessage) message
        = gst_bus_timed_pop_filtered(rig->messages.bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ELEMENT);
    const GstStructure *said = gst_message_get_structure(message);
    guint tactors = 0;
    guint bytes = 0;
    guint64 update = 0;
    fail_unless(gst_structure_has_name(said, "tactor-line-slow"));
    fail_unless(gst_structure_get(said, "tactors", G_TYPE_UINT, &tactors, "bytes", G_TYPE_UINT,
                                  &bytes, "update", G_TYPE_UINT64, &update, nullptr));
    fail_unless(tactors == 64 && bytes == 342 && update == 342 * 175 * GST_USECOND);
    rig->sockets_.unplug(large);
  }
  {
    auto rig = start(0, "<0,1,2,3,4,5,6,7,8>");
    rig->sockets_.plug(large);
    fail_unless(rig->start());
    rig->message(GST_MESSAGE_INFO);
    rig->push({ 0, 0, 0 });
    fail_if(rig->messages.has(GST_MESSAGE_INFO) || rig->messages.has(GST_MESSAGE_WARNING));
    rig->sockets_.unplug(large);
  }
}

int
main(int argc, char **argv)
{
  g_unsetenv("GST_PLUGIN_PATH_1_0"); // whose plugin has the same element
  gst_check_init(&argc, &argv);
  return check_tests::run("tactorsink_board", __FILE__);
}
