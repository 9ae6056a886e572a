// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:provider-tactordeviceprovider
 * @title: tactordeviceprovider
 * @short_description: lists connected tactor boards and gamepads
 *
 * tactordeviceprovider lists each USB serial line that may belong to a tactor board, as a
 * #GstDevice of the class `Sink/Tactile/Hardware`, and reports when one is connected or removed,
 * with or without udevd. It opens no board and does not disturb boards in use. Whether a board has
 * a Firmata sketch is known only when it plays.
 *
 * The provider also lists gamepads with rumble motors, within a second.
 *
 * gst_device_create_element() returns a `tactorsink` for the device. The name of a board is its
 * serial number, or its USB socket if it has none or another board has the same. When such a board
 * appears or disappears, the device changes (`GST_MESSAGE_DEVICE_CHANGED`).
 *
 * ## Example launch lines
 * |[
 * gst-device-monitor-1.0 Sink/Tactile
 * gst-device-monitor-1.0 --follow Sink/Tactile
 * ]|
 *
 * In Python:
 *
 * |[
 * monitor = Gst.DeviceMonitor()
 * monitor.add_filter('Sink/Tactile', None)
 * monitor.start()
 * chairs = {device.get_display_name(): device for device in monitor.get_devices()}
 * ]|
 *
 * ## Properties of a device
 * - `device.api`: "usb", "evdev" for a gamepad
 * - `device.serial`: serial number, where it has one
 * - `device.bus_path`: bus and ports, such as "1-2.3": the same as long as it stays in that socket
 * - `device.path`: of a gamepad, such as "/dev/input/event5"
 * - `device.vendor.id`, `device.product.id`: USB's, four hexadecimal digits
 * - `device.transport`: "cdc-acm", "ftdi" or "ch340"; "usb" or "bluetooth" for a gamepad
 *
 * Since: 0.1
 */
#include "gsttactordeviceprovider.h"

#include "tactor/driver.h"
#include "tactor/drivers/plugged_gamepads.h"
#include "tactor/thread.h"

#include <gst/tactile/tactile.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

GST_DEBUG_CATEGORY_STATIC(tactor_device_debug);
#define GST_CAT_DEFAULT tactor_device_debug

/* ---- a board ---- */

G_BEGIN_DECLS
#define GST_TYPE_TACTOR_DEVICE (gst_tactor_device_get_type())
G_DECLARE_FINAL_TYPE(GstTactorDevice, gst_tactor_device, GST, TACTOR_DEVICE, GstDevice)
G_END_DECLS

struct _GstTactorDevice
{
  GstDevice parent;
  const gchar *driver; ///< tactorsink's `driver`, a literal
  gchar *device;       ///< tactorsink's `device`; guarded by the object lock
};

G_DEFINE_TYPE(GstTactorDevice, gst_tactor_device, GST_TYPE_DEVICE);

static GstElement *
gst_tactor_device_create_element(GstDevice *device, const gchar *name)
{
  GstElement *element = gst_element_factory_make("tactorsink", name);
  GST_OBJECT_LOCK(device);
  g_autofree gchar *board = g_strdup(GST_TACTOR_DEVICE(device)->device);
  GST_OBJECT_UNLOCK(device);
  if (element)
    // Not driver=auto, which stands for "a board or none".
    g_object_set(element, "driver", GST_TACTOR_DEVICE(device)->driver, "device", board, nullptr);
  return element;
}

static void
gst_tactor_device_finalize(GObject *object)
{
  g_free(GST_TACTOR_DEVICE(object)->device);
  G_OBJECT_CLASS(gst_tactor_device_parent_class)->finalize(object);
}

static void
gst_tactor_device_class_init(GstTactorDeviceClass *klass)
{
  G_OBJECT_CLASS(klass)->finalize = gst_tactor_device_finalize;
  GST_DEVICE_CLASS(klass)->create_element = gst_tactor_device_create_element;
}

static void
gst_tactor_device_init(GstTactorDevice *)
{
}

namespace {

using Boards = std::vector<tactor::SerialDevice>;

/// The value of tactorsink's `device` for one of the boards.
const std::string &
name_of(const tactor::SerialDevice &board, const Boards &all)
{
  const bool has_own_serial
      = !board.serial.empty()
        && std::ranges::count(all, board.serial, &tactor::SerialDevice::serial) == 1;
  return has_own_serial ? board.serial : board.bus_path;
}

void
rename_device(GstDevice *device, const std::string &name)
{
  gchar *text = g_strdup(name.c_str());
  GST_OBJECT_LOCK(device);
  std::swap(GST_TACTOR_DEVICE(device)->device, text);
  GST_OBJECT_UNLOCK(device);
  g_free(text);
}

/// A floating device. Takes `properties`; `device` is the value of tactorsink's `device`.
GstDevice *
make_device(const std::string &display_name, GstStructure *properties, const gchar *driver,
            const std::string &device)
{
  GstCaps *caps = gst_caps_from_string(GST_TACTILE_MAP_CAPS);
  auto *made = GST_TACTOR_DEVICE(
      g_object_new(GST_TYPE_TACTOR_DEVICE, "display-name", display_name.c_str(), "device-class",
                   "Sink/Tactile/Hardware", "caps", caps, "properties", properties, nullptr));
  made->driver = driver;
  made->device = g_strdup(device.c_str());
  gst_caps_unref(caps);
  gst_structure_free(properties);
  return GST_DEVICE(made);
}

/// A floating device.
GstDevice *
make_device(const tactor::SerialDevice &board, const Boards &all)
{
  g_autofree gchar *vendor = g_strdup_printf("%04x", board.vendor);
  g_autofree gchar *product = g_strdup_printf("%04x", board.product);
  GstStructure *properties = gst_structure_new(
      "tactor-proplist", "device.api", G_TYPE_STRING, "usb", "device.bus_path", G_TYPE_STRING,
      board.bus_path.c_str(), "device.vendor.id", G_TYPE_STRING, vendor, "device.product.id",
      G_TYPE_STRING, product, "device.transport", G_TYPE_STRING, board.transport.c_str(), nullptr);
  if (!board.serial.empty())
    gst_structure_set(properties, "device.serial", G_TYPE_STRING, board.serial.c_str(), nullptr);
  return make_device(board.name.empty() ? "Tactor board" : board.name, properties, "firmata",
                     name_of(board, all));
}

/// A floating device.
GstDevice *
make_device(const tactor::Gamepad &gamepad)
{
  g_autofree gchar *vendor = g_strdup_printf("%04x", gamepad.vendor);
  g_autofree gchar *product = g_strdup_printf("%04x", gamepad.product);
  GstStructure *properties
      = gst_structure_new("tactor-proplist", "device.api", G_TYPE_STRING, "evdev", "device.path",
                          G_TYPE_STRING, gamepad.path.c_str(), "device.vendor.id", G_TYPE_STRING,
                          vendor, "device.product.id", G_TYPE_STRING, product, "device.transport",
                          G_TYPE_STRING, gamepad.is_bluetooth ? "bluetooth" : "usb", nullptr);
  return make_device(gamepad.name, properties, "gamepad", gamepad.path);
}

/// Where a provider finds devices.
struct DeviceSources
{
  tactor::MakeSerialBus make_bus = tactor::make_serial_bus;
  /// May be empty.
  ListGamepads list_gamepads = [] {
    return tactor::plugged_gamepads();
  };
  tactor::Time look_again = std::chrono::seconds(1);
};

/// Watches bus and gamepads for a started provider. One thread at a time uses the bus: the one that
/// starts the watcher, then the watcher's, then the one that deletes it.
class BoardWatcher
{
public:
  BoardWatcher(GstDeviceProvider *provider, std::unique_ptr<tactor::SerialBus> bus,
               const DeviceSources &sources)
      : provider_(provider), bus_(std::move(bus)), sources_(sources)
  {
  }

  /// To be called once. Adds all boards and gamepads that are plugged in as devices.
  [[nodiscard]] tl::expected<void, tactor::DriverError> start()
  {
    return bus_
        ->watch([this] {
          std::lock_guard lock(mutex_);
          changed_ = true;
          wake_.notify_one();
        })
        .and_then([this] { return update(); })
        .map([this] { update_gamepads(); })
        .and_then([this] { return tactor::Thread::start([this] { run(); }); })
        .map([this](tactor::Thread &&thread) { thread_ = std::move(thread); });
  }

  ~BoardWatcher()
  {
    {
      std::lock_guard lock(mutex_);
      quit_ = true;
      wake_.notify_one();
    }
    thread_.join();
    (void)bus_->watch(nullptr);
    for (const Known &known : known_)
      gst_object_unref(known.device);
    for (const KnownGamepad &known : known_gamepads_)
      gst_object_unref(known.device);
  }

  BoardWatcher(const BoardWatcher &) = delete;
  BoardWatcher &operator=(const BoardWatcher &) = delete;

private:
  void run()
  {
    std::unique_lock lock(mutex_);
    while (true) {
      const auto is_woken = [this] {
        return changed_ || quit_;
      };
      if (sources_.list_gamepads)
        wake_.wait_for(lock, sources_.look_again, is_woken);
      else
        wake_.wait(lock, is_woken);
      if (quit_)
        return;
      const bool has_changed = std::exchange(changed_, false);
      lock.unlock();
      update_gamepads();
      const auto updated = has_changed ? update() : tl::expected<void, tactor::DriverError>();
      if (!updated)
        GST_WARNING_OBJECT(provider_, "the boards cannot be listed: %s",
                           updated.error().text.c_str());
      lock.lock();
    }
  }

  /// Adds and removes devices, and changes those whose name has changed.
  tl::expected<void, tactor::DriverError> update()
  {
    const tl::expected<Boards, tactor::DriverError> listed = bus_->list();
    if (!listed)
      return tl::unexpected(listed.error());
    const Boards &boards = *listed;
    std::erase_if(known_, [&](const Known &known) {
      if (std::ranges::find(boards, known.board) != boards.end())
        return false;
      gst_device_provider_device_remove(provider_, known.device);
      gst_object_unref(known.device);
      return true;
    });
    for (const tactor::SerialDevice &board : boards) {
      const std::string &name = name_of(board, boards);
      const auto known = std::ranges::find(known_, board, &Known::board);
      if (known != known_.end() && known->name == name)
        continue;
      GstDevice *device = make_device(board, boards);
      gst_object_ref_sink(device);
      if (known == known_.end()) {
        known_.push_back({ board, name, device });
        gst_device_provider_device_add(provider_, device);
        continue;
      }
      // Another board with this serial number came or went. The old device, which the application
      // may keep, gets the new name, too.
      GstDevice *old = std::exchange(known->device, device);
      known->name = name;
      rename_device(old, name);
      gst_device_provider_device_changed(provider_, device, old);
      gst_object_unref(old);
    }
    return {};
  }

  /// Adds and removes devices. Reads the kernel's list, because the kernel does not notify of
  /// Bluetooth gamepads here.
  void update_gamepads()
  {
    if (!sources_.list_gamepads)
      return;
    const std::vector<tactor::Gamepad> gamepads = sources_.list_gamepads();
    std::erase_if(known_gamepads_, [&](const KnownGamepad &known) {
      if (std::ranges::find(gamepads, known.gamepad) != gamepads.end())
        return false;
      gst_device_provider_device_remove(provider_, known.device);
      gst_object_unref(known.device);
      return true;
    });
    for (const tactor::Gamepad &gamepad : gamepads) {
      if (std::ranges::find(known_gamepads_, gamepad, &KnownGamepad::gamepad)
          != known_gamepads_.end())
        continue;
      GstDevice *device = make_device(gamepad);
      gst_object_ref_sink(device);
      known_gamepads_.push_back({ gamepad, device });
      gst_device_provider_device_add(provider_, device);
    }
  }

  struct KnownGamepad
  {
    tactor::Gamepad gamepad;
    GstDevice *device; ///< a reference
  };

  /// A board and its device.
  struct Known
  {
    tactor::SerialDevice board;
    std::string name;  ///< tactorsink's `device`
    GstDevice *device; ///< a reference
  };

  GstDeviceProvider *provider_; ///< not owned: it owns the watcher
  std::unique_ptr<tactor::SerialBus> bus_;
  const DeviceSources &sources_; ///< not owned
  std::vector<Known> known_;
  std::vector<KnownGamepad> known_gamepads_;
  std::mutex mutex_; ///< guards all below
  std::condition_variable wake_;
  bool changed_ = false;
  bool quit_ = false;
  tactor::Thread thread_;
};

} // namespace

/* ---- the provider ---- */

struct GstTactorDeviceProviderPrivate
{
  DeviceSources sources;
  std::unique_ptr<BoardWatcher> watcher; ///< while started
};

struct _GstTactorDeviceProvider
{
  GstDeviceProvider parent;
  GstTactorDeviceProviderPrivate *priv;
};

#define gst_tactor_device_provider_parent_class parent_class
G_DEFINE_TYPE_WITH_CODE(GstTactorDeviceProvider, gst_tactor_device_provider,
                        GST_TYPE_DEVICE_PROVIDER,
                        GST_DEBUG_CATEGORY_INIT(tactor_device_debug, "tactordeviceprovider", 0,
                                                "tactor device provider"));
GST_DEVICE_PROVIDER_REGISTER_DEFINE(tactordeviceprovider, "tactordeviceprovider", GST_RANK_PRIMARY,
                                    GST_TYPE_TACTOR_DEVICE_PROVIDER);

static GList *
gst_tactor_device_provider_probe(GstDeviceProvider *provider)
{
  const DeviceSources &sources = GST_TACTOR_DEVICE_PROVIDER(provider)->priv->sources;
  GList *devices = nullptr;
  const tl::expected<Boards, tactor::DriverError> boards = sources.make_bus().and_then(
      [](const std::unique_ptr<tactor::SerialBus> &bus) { return bus->list(); });
  if (boards)
    for (const tactor::SerialDevice &board : *boards)
      devices = g_list_append(devices, make_device(board, *boards));
  else
    GST_WARNING_OBJECT(provider, "the boards cannot be listed: %s", boards.error().text.c_str());
  if (sources.list_gamepads)
    for (const tactor::Gamepad &gamepad : sources.list_gamepads())
      devices = g_list_append(devices, make_device(gamepad));
  return devices;
}

static gboolean
gst_tactor_device_provider_start(GstDeviceProvider *provider)
{
  GstTactorDeviceProviderPrivate *priv = GST_TACTOR_DEVICE_PROVIDER(provider)->priv;
  const tl::expected<void, tactor::DriverError> started
      = priv->sources.make_bus().and_then([&](std::unique_ptr<tactor::SerialBus> &&bus) {
          priv->watcher = std::make_unique<BoardWatcher>(provider, std::move(bus), priv->sources);
          return priv->watcher->start();
        });
  if (started)
    return TRUE;
  GST_WARNING_OBJECT(provider, "the boards cannot be watched: %s", started.error().text.c_str());
  priv->watcher.reset();
  return FALSE;
}

static void
gst_tactor_device_provider_stop(GstDeviceProvider *provider)
{
  GST_TACTOR_DEVICE_PROVIDER(provider)->priv->watcher.reset();
}

static void
gst_tactor_device_provider_finalize(GObject *object)
{
  delete GST_TACTOR_DEVICE_PROVIDER(object)->priv;
  G_OBJECT_CLASS(parent_class)->finalize(object);
}

static void
gst_tactor_device_provider_class_init(GstTactorDeviceProviderClass *klass)
{
  GstDeviceProviderClass *provider_class = GST_DEVICE_PROVIDER_CLASS(klass);

  G_OBJECT_CLASS(klass)->finalize = gst_tactor_device_provider_finalize;
  gst_device_provider_class_set_static_metadata(
      provider_class, "Tactor boards", "Sink/Tactile/Hardware",
      "Lists the tactor boards and gamepads that are plugged in", "The visuotactile authors");
  provider_class->probe = GST_DEBUG_FUNCPTR(gst_tactor_device_provider_probe);
  provider_class->start = GST_DEBUG_FUNCPTR(gst_tactor_device_provider_start);
  provider_class->stop = GST_DEBUG_FUNCPTR(gst_tactor_device_provider_stop);
}

static void
gst_tactor_device_provider_init(GstTactorDeviceProvider *self)
{
  self->priv = new GstTactorDeviceProviderPrivate;
}

GstDeviceProvider *
gst_tactor_device_provider_new(tactor::MakeSerialBus make_bus, ListGamepads list_gamepads,
                               tactor::Time look_again)
{
  auto *self = GST_TACTOR_DEVICE_PROVIDER(g_object_new(GST_TYPE_TACTOR_DEVICE_PROVIDER, nullptr));
  self->priv->sources = { std::move(make_bus), std::move(list_gamepads), look_again };
  return GST_DEVICE_PROVIDER(self);
}
