// SPDX-License-Identifier: LGPL-2.1-or-later
//
// tactordeviceprovider on a bus in memory. The provider and tactorsink are linked into this
// program, as they must not be loaded a second time from a plugin.
#include "gst/tactor/gsttactordeviceprovider.h"
#include "gst/tactor/gsttactorsink.h"
#include "tactor/driver.h"

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using tactor::DriverError;
using tactor::SerialDevice;

namespace {

constexpr GstClockTime kPatience = 60 * GST_SECOND;

const SerialDevice kMega{ .serial = "7593331313335110F0D1",
                          .bus_path = "1-2.3",
                          .name = "Arduino (www.arduino.cc) Mega 2560",
                          .vendor = 0x2341,
                          .product = 0x0042,
                          .transport = "cdc-acm" };
const SerialDevice kClone{ .serial = "",
                           .bus_path = "1-4",
                           .name = "",
                           .vendor = 0x1a86,
                           .product = 0x7523,
                           .transport = "ch340" };

/// The boards that are plugged in, shared by all buses.
class Sockets
{
public:
  std::vector<SerialDevice> plugged() const
  {
    std::lock_guard lock(mutex_);
    return plugged_;
  }

  void plug(std::vector<SerialDevice> boards)
  {
    std::lock_guard lock(mutex_);
    plugged_ = std::move(boards);
    if (changed_)
      changed_();
  }

  void watch(std::function<void()> changed)
  {
    std::lock_guard lock(mutex_);
    changed_ = std::move(changed);
  }

  bool is_watched() const
  {
    std::lock_guard lock(mutex_);
    return changed_ != nullptr;
  }

  std::atomic<bool> broken{ false };
  std::atomic<int> buses{ 0 };
  std::atomic<bool> used_by_two{ false }; ///< two threads called a bus at the same time

private:
  mutable std::mutex mutex_;
  std::vector<SerialDevice> plugged_;
  std::function<void()> changed_;
};

class Bus final : public tactor::SerialBus
{
public:
  explicit Bus(Sockets &sockets) : sockets_(sockets)
  {
    sockets_.buses++;
  }
  ~Bus() override
  {
    sockets_.buses--;
  }

  tl::expected<std::vector<SerialDevice>, DriverError> list() override
  {
    const Use use(*this);
    if (sockets_.broken)
      return tl::unexpected(DriverError{ DriverError::Kind::failed, "the bus is broken" });
    return sockets_.plugged();
  }
  tl::expected<std::unique_ptr<tactor::SerialPort>, DriverError>
  open(const SerialDevice &, tactor::SerialPort::Events, std::stop_token) override
  {
    return tl::unexpected(DriverError{ DriverError::Kind::failed, "nobody opens boards here" });
  }
  tl::expected<void, DriverError> watch(std::function<void()> changed) override
  {
    const Use use(*this);
    sockets_.watch(std::move(changed));
    return {};
  }

private:
  struct Use
  {
    explicit Use(Bus &bus) : bus_(bus)
    {
      if (bus_.users_++ > 0)
        bus_.sockets_.used_by_two = true;
    }
    ~Use()
    {
      bus_.users_--;
    }
    Bus &bus_;
  };

  Sockets &sockets_;
  std::atomic<int> users_{ 0 };
};

/// A provider with its own sockets.
struct ProviderRig
{
  ProviderRig()
      : provider(gst_tactor_device_provider_new([this] { return std::make_unique<Bus>(sockets); }))
  {
    bus = gst_device_provider_get_bus(provider);
  }
  ~ProviderRig()
  {
    gst_object_unref(bus);
    ck_assert_int_eq(GST_OBJECT_REFCOUNT_VALUE(provider), 1);
    gst_object_unref(provider);
    ck_assert_int_eq(sockets.buses, 0);
    fail_if(sockets.used_by_two);
    fail_if(sockets.is_watched());
  }
  ProviderRig(const ProviderRig &) = delete;
  ProviderRig &operator=(const ProviderRig &) = delete;

  /// The device of the next message of this type.
  GstDevice *next(GstMessageType type)
  {
    GstMessage *message = gst_bus_timed_pop_filtered(bus, kPatience, type);
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

  Sockets sockets;
  GstDeviceProvider *provider;
  GstBus *bus;
};

void
same(const std::string &text, const std::string &expected)
{
  ck_assert_str_eq(text.c_str(), expected.c_str());
}

void
free_devices(GList *devices)
{
  g_list_free_full(devices, gst_object_unref);
}

std::string
display_name(GstDevice *device)
{
  g_autofree gchar *name = gst_device_get_display_name(device);
  return name;
}

/// A device's property, empty if there is none of this name.
std::string
property(GstDevice *device, const char *name)
{
  GstStructure *properties = gst_device_get_properties(device);
  const gchar *text = gst_structure_get_string(properties, name);
  const std::string value = text ? text : "";
  gst_structure_free(properties);
  return value;
}

/// The property `device` of the tactorsink that the device creates.
std::string
sink_device(GstDevice *device, const char *expected_driver = "firmata")
{
  GstElement *element = gst_device_create_element(device, "chair");
  fail_unless(element != nullptr);
  fail_unless(GST_IS_TACTOR_SINK(element));
  ck_assert_str_eq(GST_OBJECT_NAME(element), "chair");
  g_autofree gchar *driver = nullptr;
  g_autofree gchar *name = nullptr;
  g_object_get(element, "driver", &driver, "device", &name, nullptr);
  ck_assert_str_eq(driver, expected_driver);
  gst_object_ref_sink(element);
  gst_object_unref(element);
  return name;
}

} // namespace

CHECK_TEST(test_probe)
{
  ProviderRig rig;
  fail_unless(gst_device_provider_get_devices(rig.provider) == nullptr);
  rig.sockets.plug({ kMega, kClone });
  GList *devices = gst_device_provider_get_devices(rig.provider);
  ck_assert_uint_eq(g_list_length(devices), 2);

  auto *mega = GST_DEVICE(devices->data);
  same(display_name(mega), "Arduino (www.arduino.cc) Mega 2560");
  fail_unless(gst_device_has_classes(mega, "Sink/Tactile"));
  fail_if(gst_device_has_classes(mega, "Video"));
  fail_if(gst_device_has_classes(mega, "Audio"));
  same(property(mega, "device.serial"), "7593331313335110F0D1");
  same(property(mega, "device.bus_path"), "1-2.3");
  same(property(mega, "device.vendor.id"), "2341");
  same(property(mega, "device.product.id"), "0042");
  same(property(mega, "device.transport"), "cdc-acm");
  GstCaps *caps = gst_device_get_caps(mega);
  GstCaps *grid = gst_caps_from_string(
      "application/x-tactile-map, rows=(int)3, columns=(int)3, framerate=(fraction)30/1");
  fail_unless(gst_caps_is_subset(grid, caps));
  gst_caps_unref(grid);
  gst_caps_unref(caps);

  auto *clone = GST_DEVICE(devices->next->data);
  same(display_name(clone), "Tactor board");
  same(property(clone, "device.serial"), "");
  same(property(clone, "device.transport"), "ch340");
  free_devices(devices);
}

/// The device's tactorsink names the serial number, or the socket if there is none or two boards
/// share it.
CHECK_TEST(test_create_element)
{
  ProviderRig rig;
  SerialDevice twin = kMega;
  twin.bus_path = "3-1";
  SerialDevice other = kMega;
  other.bus_path = "3-2";
  other.serial = "1";
  rig.sockets.plug({ kMega, kClone, other });
  GList *devices = gst_device_provider_get_devices(rig.provider);
  same(sink_device(GST_DEVICE(devices->data)), kMega.serial);
  same(sink_device(GST_DEVICE(devices->next->data)), "1-4");
  same(sink_device(GST_DEVICE(devices->next->next->data)), "1");
  free_devices(devices);

  rig.sockets.plug({ kMega, twin });
  devices = gst_device_provider_get_devices(rig.provider);
  same(sink_device(GST_DEVICE(devices->data)), "1-2.3");
  same(sink_device(GST_DEVICE(devices->next->data)), "3-1");
  free_devices(devices);
}

/// Boards present at the start are listed at once. Later changes give messages.
CHECK_TEST(test_plugging)
{
  ProviderRig rig;
  rig.sockets.plug({ kMega });
  fail_unless(gst_device_provider_can_monitor(rig.provider));
  fail_unless(gst_device_provider_start(rig.provider));
  GList *devices = gst_device_provider_get_devices(rig.provider);
  ck_assert_uint_eq(g_list_length(devices), 1);
  GstDevice *mega = rig.next(GST_MESSAGE_DEVICE_ADDED);
  fail_unless(mega == devices->data);
  free_devices(devices);

  rig.sockets.plug({ kClone, kMega });
  GstDevice *clone = rig.next(GST_MESSAGE_DEVICE_ADDED);
  same(property(clone, "device.bus_path"), "1-4");
  rig.sockets.plug({ kClone });
  GstDevice *removed = rig.next(GST_MESSAGE_DEVICE_REMOVED);
  fail_unless(removed == mega);
  gst_object_unref(removed);

  // Another board in the same socket is another device.
  SerialDevice other = kMega;
  other.bus_path = kClone.bus_path;
  rig.sockets.plug({ other });
  removed = rig.next(GST_MESSAGE_DEVICE_REMOVED);
  fail_unless(removed == clone);
  gst_object_unref(removed);
  GstDevice *added = rig.next(GST_MESSAGE_DEVICE_ADDED);
  same(property(added, "device.serial"), kMega.serial);
  devices = gst_device_provider_get_devices(rig.provider);
  ck_assert_uint_eq(g_list_length(devices), 1);
  fail_unless(devices->data == added);
  free_devices(devices);

  gst_device_provider_stop(rig.provider);
  fail_unless(gst_bus_pop(rig.bus) == nullptr);
  for (GstDevice *device : { mega, clone, added }) {
    ck_assert_int_eq(GST_OBJECT_REFCOUNT_VALUE(device), 1);
    gst_object_unref(device);
  }
}

/// While two boards have the same serial number, both are named by their sockets.
CHECK_TEST(test_twin_comes_later)
{
  ProviderRig rig;
  SerialDevice twin = kMega;
  twin.bus_path = "3-1";
  rig.sockets.plug({ kMega });
  fail_unless(gst_device_provider_start(rig.provider));
  GstDevice *first = rig.next(GST_MESSAGE_DEVICE_ADDED);
  same(sink_device(first), kMega.serial);

  rig.sockets.plug({ kMega, twin });
  GstDevice *changed = rig.next(GST_MESSAGE_DEVICE_CHANGED);
  same(sink_device(changed), "1-2.3");
  GstDevice *second = rig.next(GST_MESSAGE_DEVICE_ADDED);
  same(sink_device(second), "3-1");
  // The device object from before still means the same board.
  same(sink_device(first), "1-2.3");
  GList *devices = gst_device_provider_get_devices(rig.provider);
  ck_assert_uint_eq(g_list_length(devices), 2);
  fail_unless(g_list_find(devices, changed) && g_list_find(devices, second));
  free_devices(devices);

  rig.sockets.plug({ twin });
  GstDevice *removed = rig.next(GST_MESSAGE_DEVICE_REMOVED);
  fail_unless(removed == changed);
  GstDevice *alone = rig.next(GST_MESSAGE_DEVICE_CHANGED);
  same(sink_device(alone), kMega.serial);
  same(property(alone, "device.bus_path"), "3-1");
  gst_device_provider_stop(rig.provider);
  for (GstDevice *device : { first, second, changed, removed, alone })
    gst_object_unref(device);
}

/// Can be stopped and started again. The last reference stops it, too.
CHECK_TEST(test_stop_and_start)
{
  ProviderRig rig;
  for (int i = 0; i < 3; i++) {
    rig.sockets.plug({ kMega });
    fail_unless(gst_device_provider_start(rig.provider));
    fail_unless(rig.sockets.is_watched());
    gst_object_unref(rig.next(GST_MESSAGE_DEVICE_ADDED));
    gst_device_provider_stop(rig.provider);
    fail_if(rig.sockets.is_watched());
    rig.sockets.plug({});
    fail_unless(gst_device_provider_get_devices(rig.provider) == nullptr);
  }
  fail_unless(gst_device_provider_start(rig.provider));
  fail_unless(gst_bus_pop(rig.bus) == nullptr);
}

CHECK_TEST(test_broken_bus)
{
  ProviderRig rig;
  rig.sockets.plug({ kMega });
  rig.sockets.broken = true;
  fail_unless(gst_device_provider_get_devices(rig.provider) == nullptr);
  fail_if(gst_device_provider_start(rig.provider));
  fail_if(rig.sockets.is_watched());

  // A temporary fault hides no boards.
  rig.sockets.broken = false;
  fail_unless(gst_device_provider_start(rig.provider));
  gst_object_unref(rig.next(GST_MESSAGE_DEVICE_ADDED));
  rig.sockets.broken = true;
  rig.sockets.plug({ kMega, kClone });
  rig.sockets.broken = false;
  rig.sockets.plug({ kMega, kClone });
  GstDevice *clone = rig.next(GST_MESSAGE_DEVICE_ADDED);
  same(property(clone, "device.bus_path"), "1-4");
  gst_object_unref(clone);
  gst_device_provider_stop(rig.provider);
}

/// A thread plugs boards in and out while another one lists them and then stops the provider.
CHECK_TEST(test_many_changes)
{
  ProviderRig rig;
  SerialDevice last = kMega;
  last.bus_path = "9-9";
  fail_unless(gst_device_provider_start(rig.provider));
  std::atomic<bool> done{ false };
  std::thread plugger([&] {
    for (int i = 0; i < 2000; i++)
      rig.sockets.plug(i % 3 ? std::vector<SerialDevice>{ kMega, kClone }
                             : std::vector<SerialDevice>{ kClone });
    rig.sockets.plug({ last });
    done = true;
  });
  while (!done)
    free_devices(gst_device_provider_get_devices(rig.provider));
  plugger.join();

  // No device is removed twice, and the remaining one is plugged in. The provider may still be
  // catching up.
  std::vector<GstDevice *> there;
  const auto is_settled = [&] {
    return there.size() == 1 && property(there[0], "device.bus_path") == "9-9"
           && !gst_bus_have_pending(rig.bus);
  };
  while (!is_settled()) {
    GstMessage *message = gst_bus_timed_pop_filtered(
        rig.bus, kPatience,
        static_cast<GstMessageType>(GST_MESSAGE_DEVICE_ADDED | GST_MESSAGE_DEVICE_REMOVED));
    fail_unless(message != nullptr);
    GstDevice *device = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_DEVICE_ADDED) {
      gst_message_parse_device_added(message, &device);
      there.push_back(device);
    } else {
      gst_message_parse_device_removed(message, &device);
      ck_assert_uint_eq(std::erase(there, device), 1);
      gst_object_unref(device); // the message's reference
      gst_object_unref(device); // the one in `there`
    }
    gst_message_unref(message);
  }
  gst_device_provider_stop(rig.provider);
  gst_object_unref(there[0]);
}

static void
register_tactorsink(void)
{
  fail_unless(GST_ELEMENT_REGISTER(tactorsink, nullptr));
}

/// Gamepads come, go, and are told apart from boards.
CHECK_TEST(test_gamepads)
{
  const tactor::Gamepad xbox{ .name = "Xbox Wireless Controller",
                              .path = "/dev/input/event5",
                              .vendor = 0x045e,
                              .product = 0x0b13,
                              .is_bluetooth = true };
  Sockets sockets;
  std::mutex mutex;
  std::vector<tactor::Gamepad> plugged;
  GstDeviceProvider *provider
      = gst_tactor_device_provider_new([&] { return std::make_unique<Bus>(sockets); },
                                       [&] {
                                         const std::lock_guard lock(mutex);
                                         return plugged;
                                       },
                                       std::chrono::milliseconds(1));
  const auto plug = [&](std::vector<tactor::Gamepad> gamepads) {
    const std::lock_guard lock(mutex);
    plugged = std::move(gamepads);
  };
  GstBus *bus = gst_device_provider_get_bus(provider);
  fail_unless(gst_device_provider_start(provider));
  plug({ xbox });
  GstMessage *message = gst_bus_timed_pop_filtered(bus, kPatience, GST_MESSAGE_DEVICE_ADDED);
  GstDevice *device = nullptr;
  gst_message_parse_device_added(message, &device);
  gst_message_unref(message);
  same(display_name(device), xbox.name);
  same(property(device, "device.api"), "evdev");
  same(property(device, "device.path"), xbox.path);
  same(property(device, "device.vendor.id"), "045e");
  same(property(device, "device.product.id"), "0b13");
  same(property(device, "device.transport"), "bluetooth");
  same(sink_device(device, "gamepad"), xbox.path);
  gst_object_unref(device);
  plug({});
  message = gst_bus_timed_pop_filtered(bus, kPatience, GST_MESSAGE_DEVICE_REMOVED);
  fail_unless(message != nullptr);
  gst_message_unref(message);
  gst_device_provider_stop(provider);

  sockets.broken = true; // gamepads are listed nevertheless
  plug({ xbox });
  GList *devices = gst_device_provider_get_devices(provider);
  ck_assert_uint_eq(g_list_length(devices), 1);
  free_devices(devices);
  gst_object_unref(bus);
  gst_object_unref(provider);
}

int
main(int argc, char **argv)
{
  g_unsetenv("GST_PLUGIN_PATH_1_0");
  gst_check_init(&argc, &argv);
  register_tactorsink();
  return check_tests::run("tactordeviceprovider", __FILE__);
}
