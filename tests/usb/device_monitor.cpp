// SPDX-License-Identifier: LGPL-2.1-or-later
//
// End to end, as in a player: GstDeviceMonitor, the plugin's tactordeviceprovider, USB, a board
// with StandardFirmata.
#include "support/boards/emulated_board.h"

#include <memory>
#include <string>
#include <utility>

#include "support/check_tests.h"

using namespace usb_test;

namespace {

/// A running monitor of tactors.
class Monitor
{
public:
  Monitor() : monitor_(gst_device_monitor_new()), bus_(gst_device_monitor_get_bus(monitor_))
  {
    fail_unless(gst_device_monitor_add_filter(monitor_, "Sink/Tactile", nullptr) != 0);
    fail_unless(gst_device_monitor_start(monitor_));
  }
  ~Monitor()
  {
    gst_device_monitor_stop(monitor_);
    gst_object_unref(bus_);
    gst_object_unref(monitor_);
  }
  Monitor(const Monitor &) = delete;
  Monitor &operator=(const Monitor &) = delete;

  /// The device of the next message of a type. Transfer full.
  GstDevice *next(GstMessageType type)
  {
    GstMessage *message
        = gst_bus_timed_pop_filtered(bus_, std::chrono::nanoseconds(kPatience).count(), type);
    // The bus cannot filter these types one by one.
    fail_unless(message && GST_MESSAGE_TYPE(message) == type, "no message of type %s",
                gst_message_type_get_name(type));
    GstDevice *device = nullptr;
    if (type == GST_MESSAGE_DEVICE_ADDED)
      gst_message_parse_device_added(message, &device);
    else if (type == GST_MESSAGE_DEVICE_CHANGED)
      gst_message_parse_device_changed(message, &device, nullptr);
    else
      gst_message_parse_device_removed(message, &device);
    gst_message_unref(message);
    return device;
  }

  guint count()
  {
    GList *devices = gst_device_monitor_get_devices(monitor_);
    const guint count = g_list_length(devices);
    g_list_free_full(devices, gst_object_unref);
    return count;
  }

private:
  GstDeviceMonitor *monitor_;
  GstBus *bus_;
};

std::string
property(GstDevice *device, const char *name)
{
  GstStructure *properties = gst_device_get_properties(device);
  const gchar *text = gst_structure_get_string(properties, name);
  const std::string value = text ? text : "";
  gst_structure_free(properties);
  return value;
}

} // namespace

/// A board that is present, one that is added, and one that is removed.
CHECK_TEST(test_plugging)
{
  EmulatedUsb usb;
  EmulatedBoard mega(usb, {});
  Monitor monitor;
  GstDevice *first = monitor.next(GST_MESSAGE_DEVICE_ADDED);
  fail_unless(property(first, "device.serial") == BoardDescription{}.serial);
  fail_unless(property(first, "device.transport") == "cdc-acm");
  g_autofree gchar *name = gst_device_get_display_name(first);
  ck_assert_str_eq(name, "Arduino (www.arduino.cc) Mega 2560");

  EmulatedBoard clone(usb, { .transport = Transport::ch340, .port = "1-2", .serial = "" });
  GstDevice *second = monitor.next(GST_MESSAGE_DEVICE_ADDED);
  fail_unless(property(second, "device.bus_path") == "1-2");
  fail_unless(property(second, "device.transport") == "ch340");
  ck_assert_uint_eq(monitor.count(), 2);

  mega.unplug();
  GstDevice *gone = monitor.next(GST_MESSAGE_DEVICE_REMOVED);
  fail_unless(gone == first);
  ck_assert_uint_eq(monitor.count(), 1);
  for (GstDevice *device : { first, second, gone })
    gst_object_unref(device);
}

/// Two boards with the same serial number.
CHECK_TEST(test_twin)
{
  EmulatedUsb usb;
  EmulatedBoard board(usb, { .port = "1-1" });
  Monitor monitor;
  GstDevice *alone = monitor.next(GST_MESSAGE_DEVICE_ADDED);
  EmulatedBoard twin(usb, { .port = "1-2" });
  GstDevice *changed = monitor.next(GST_MESSAGE_DEVICE_CHANGED);
  GstDevice *added = monitor.next(GST_MESSAGE_DEVICE_ADDED);
  ck_assert_uint_eq(monitor.count(), 2);
  for (const auto &[device, socket] : { std::pair(changed, "1-1"), std::pair(added, "1-2") }) {
    GstElement *sink = gst_device_create_element(device, nullptr);
    gst_object_ref_sink(sink);
    g_autofree gchar *name = nullptr;
    g_object_get(sink, "device", &name, nullptr);
    ck_assert_str_eq(name, socket);
    gst_object_unref(sink);
  }
  for (GstDevice *device : { alone, changed, added })
    gst_object_unref(device);
}

/// The element of create_element() plays on the device's board.
CHECK_TEST(test_element)
{
  EmulatedUsb usb;
  const auto other_firmware = std::make_shared<Firmware>();
  const auto firmware = std::make_shared<Firmware>();
  EmulatedBoard other(usb, { .port = "1-1", .serial = "1" }, other_firmware);
  EmulatedBoard board(usb, { .port = "1-2", .serial = "2" }, firmware);
  Monitor monitor;
  gst_object_unref(monitor.next(GST_MESSAGE_DEVICE_ADDED));
  GstDevice *device = monitor.next(GST_MESSAGE_DEVICE_ADDED);
  fail_unless(property(device, "device.serial") == "2");

  GstElement *sink = gst_device_create_element(device, nullptr);
  fail_unless(sink != nullptr);
  gst_object_ref_sink(sink);
  ck_assert_int_eq(gst_element_set_state(sink, GST_STATE_PAUSED), GST_STATE_CHANGE_ASYNC);
  GstPad *pad = gst_element_get_static_pad(sink, "sink");
  fail_unless(gst_pad_send_event(pad, gst_event_new_stream_start("film"))); // the board is open
  gst_object_unref(pad);
  GstStructure *stats = nullptr;
  g_object_get(sink, "actuation-stats", &stats, nullptr);
  gboolean connected = FALSE;
  fail_unless(gst_structure_get_boolean(stats, "connected", &connected) && connected);
  ck_assert_str_eq(gst_structure_get_string(stats, "firmware"), "StandardFirmata.ino 2.5");
  gst_structure_free(stats);
  ck_assert_int_eq(gst_element_set_state(sink, GST_STATE_NULL), GST_STATE_CHANGE_SUCCESS);
  gst_object_unref(sink);
  gst_object_unref(device);
  fail_if(board.bytes().empty());
  fail_unless(other.bytes().empty());
}

CHECK_MAIN_AFTER(device_monitor, -1, begin_emulation())
