// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactorsink on SDL's virtual gamepad.
#include "support/two_devices.h"
#include "support/virtual_gamepad.h"

#include <vector>

#include "support/playing.h"

#include <gst/tactile/tactile.h>

#include "support/check_tests.h"

namespace {

/// A sink that does not wait for the clock, and its gamepad.
struct GamepadRig
{
  GamepadRig()
  {
    g_object_set(element, "driver", "gamepad", "device", "virtual pad", "sync", FALSE, "async",
                 FALSE, "rate", 0.0, "compensation", 2, "ramp-in", guint64{ 0 }, nullptr);
    sink_pad = gst_element_get_static_pad(element, "sink");
  }
  ~GamepadRig()
  {
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(sink_pad);
    gst_object_unref(element);
  }

  void start(guint rows, guint columns)
  {
    fail_if(gst_element_set_state(element, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    GstSegment segment;
    gst_segment_init(&segment, GST_FORMAT_TIME);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_stream_start("film")));
    g_autoptr(GstCaps) caps = gst_tactile_map_caps_new(rows, columns, 25, 1);
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_caps(caps)));
    fail_unless(gst_pad_send_event(sink_pad, gst_event_new_segment(&segment)));
  }
  void push(const std::vector<gfloat> &levels)
  {
    GstBuffer *map = gst_tactile_map_buffer_new(levels.data(), levels.size());
    GST_BUFFER_PTS(map) = frame++ * 40 * GST_MSECOND;
    GST_BUFFER_DURATION(map) = 40 * GST_MSECOND;
    ck_assert_int_eq(gst_pad_chain(sink_pad, map), GST_FLOW_OK);
  }

  /// How many of the messages so far have this in their text; takes all of the type.
  int times_said(GstMessageType type, const char *part) const
  {
    int count = 0;
    while (GstMessage *message = gst_bus_pop_filtered(messages.bus, type)) {
      count += Said(message).text.find(part) != std::string::npos;
      gst_message_unref(message);
    }
    return count;
  }

  VirtualPad pad{ "virtual pad" };
  GstElement *element
      = GST_ELEMENT(gst_object_ref_sink(gst_element_factory_make("tactorsink", nullptr)));
  ElementBus messages{ element };
  GstPad *sink_pad = nullptr;
  guint frame = 0;
};

constexpr std::array<int, 4> kZero{};

} // namespace

/// The left half of the map is the low motor, the right half the high one; no cell is dropped.
CHECK_TEST(test_halves)
{
  GamepadRig rig;
  rig.start(1, 4);
  rig.push({ 0, 1, 0, 0 });
  rig.pad.wait_for({ 65535, 0, 0, 0 });
  rig.push({ 0, 0, 0, 1 });
  rig.pad.wait_for({ 0, 65535, 0, 0 });
  rig.push({ 1, 0, 1, 0 });
  rig.pad.wait_for({ 65535, 65535, 0, 0 });
  ck_assert_int_eq(rig.times_said(GST_MESSAGE_INFO, "share motors"), 1);
  ck_assert_int_eq(rig.times_said(GST_MESSAGE_WARNING, "no tactor"), 0);
}

CHECK_TEST(test_no_watchdog)
{
  GamepadRig rig;
  rig.start(1, 2);
  rig.push({ 1, 1 });
  rig.pad.wait_for({ 65535, 65535, 0, 0 });
  ck_assert_int_eq(rig.times_said(GST_MESSAGE_WARNING, "has no watchdog"), 1);
}

CHECK_TEST(test_mapping)
{
  GamepadRig rig;
  g_object_set(rig.element, "mapping", "3,2,1,0", nullptr);
  rig.start(1, 4);
  rig.push({ 1, 0, 0, 0 });
  rig.pad.wait_for({ 0, 0, 0, 65535 });
  rig.push({ 0, 1, 0, 1 });
  rig.pad.wait_for({ 65535, 0, 65535, 0 });
}

CHECK_TEST(test_zero_on_ways_out)
{
  for (const GstState state : { GST_STATE_PAUSED, GST_STATE_READY, GST_STATE_NULL }) {
    GamepadRig rig;
    rig.start(1, 2);
    rig.push({ 1, 1 });
    rig.pad.wait_for({ 65535, 65535, 0, 0 });
    gst_element_set_state(rig.element, state);
    rig.pad.wait_for(kZero);
  }
  for (GstEvent *event : { gst_event_new_eos(), gst_event_new_flush_start() }) {
    GamepadRig rig;
    rig.start(1, 2);
    rig.push({ 1, 1 });
    rig.pad.wait_for({ 65535, 65535, 0, 0 });
    fail_unless(gst_pad_send_event(rig.sink_pad, event));
    rig.pad.wait_for(kZero);
  }
  // A map of the wrong size is an error, on which an application stops the pipeline.
  GamepadRig rig;
  rig.start(1, 2);
  rig.push({ 1, 1 });
  rig.pad.wait_for({ 65535, 65535, 0, 0 });
  const std::array<gfloat, 3> wrong{ 1, 1, 1 };
  GstBuffer *map = gst_tactile_map_buffer_new(wrong.data(), wrong.size());
  GST_BUFFER_PTS(map) = GST_SECOND;
  ck_assert_int_eq(gst_pad_chain(rig.sink_pad, map), GST_FLOW_ERROR);
  ck_assert_int_eq(rig.times_said(GST_MESSAGE_ERROR, "wrong size"), 1);
  gst_element_set_state(rig.element, GST_STATE_NULL);
  rig.pad.wait_for(kZero);
}

/// The pad's buttons stay with a game that plays on it, too: while the film is felt, and after.
CHECK_TEST(test_buttons_of_a_game)
{
  GamepadRig rig;
  SDL_GameController *game = nullptr;
  for (int i = 0; i < SDL_NumJoysticks(); i++)
    if (SDL_JoystickGetDeviceInstanceID(i) == rig.pad.id())
      game = SDL_GameControllerOpen(i);
  fail_unless(game != nullptr);
  const auto hears = [&](bool pressed) {
    SDL_FlushEvents(SDL_FIRSTEVENT, SDL_LASTEVENT);
    SDL_JoystickSetVirtualButton(SDL_GameControllerGetJoystick(game), SDL_CONTROLLER_BUTTON_A,
                                 pressed);
    SDL_JoystickUpdate(); // the driver's thread may have done so already
    bool came = false;
    for (SDL_Event event; SDL_PollEvent(&event);)
      came |= event.type == (pressed ? SDL_CONTROLLERBUTTONDOWN : SDL_CONTROLLERBUTTONUP)
              && event.cbutton.which == rig.pad.id()
              && event.cbutton.button == SDL_CONTROLLER_BUTTON_A;
    return came;
  };
  fail_unless(hears(true));
  fail_unless(hears(false));
  rig.start(1, 2);
  rig.push({ 1, 1 });
  rig.pad.wait_for({ 65535, 65535, 0, 0 });
  fail_unless(hears(true));
  gst_element_set_state(rig.element, GST_STATE_NULL);
  rig.pad.wait_for(kZero);
  fail_unless(hears(false));
  SDL_GameControllerClose(game);
}

/// A gamepad beside a chair.
CHECK_TEST(test_with_a_chair)
{
  VirtualPad pad("virtual pad");
  TwoDevices devices("driver=simulator", "driver=gamepad device=\"virtual pad\"");
  // The left motor is on from 80 to 400 ms, the right one from 280 to 600 ms: kSlowRiseMs early.
  devices.play_until(240 * GST_MSECOND);
  pad.wait_for_grips({ 65535, 0 });
  devices.play_until(500 * GST_MSECOND);
  pad.wait_for_grips({ 0, 65535 });
  devices.expect_one_film();
  pad.wait_for(kZero);
}

CHECK_MAIN(tactorsink_gamepad)
