// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/boards/emulated_usb.h"

#include <linux/usbdevice_fs.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace usb_test {

void
begin_emulation()
{
  std::signal(SIGHUP, SIG_IGN);
  g_log_set_always_fatal(static_cast<GLogLevelFlags>(G_LOG_FATAL_MASK));
  for (const char *domain : std::initializer_list<const char *>{ nullptr, "GLib", "GLib-GObject",
                                                                 "GLib-GIO", "GStreamer" })
    g_log_set_handler(
        domain, static_cast<GLogLevelFlags>(G_LOG_LEVEL_CRITICAL | G_LOG_LEVEL_WARNING),
        [](const gchar *, GLogLevelFlags, const gchar *text, gpointer) {
          if (!std::strstr(text, "IoctlClient"))
            g_error("%s", text);
        },
        nullptr);
}

namespace {

struct usbdevfs_urb *
as_urb(UMockdevIoctlData *data)
{
  return reinterpret_cast<struct usbdevfs_urb *>(data->data);
}

/// The data that the argument points to. Empty if the host died meanwhile.
template <class T>
std::optional<T>
resolve(UMockdevIoctlData *argument)
{
  UMockdevIoctlData *data = umockdev_ioctl_data_resolve(argument, 0, sizeof(T), nullptr);
  if (!data)
    return std::nullopt;
  T value;
  std::memcpy(&value, data->data, sizeof value);
  g_object_unref(data);
  return value;
}

} // namespace

EmulatedUsb::EmulatedUsb() : testbed_(umockdev_testbed_new())
{
  // Must be called while a test bed exists: the first answer is cached.
  if (!umockdev_in_mock_environment())
    throw std::runtime_error("this must be run by umockdev-wrapper");
  setenv("XDG_STATE_HOME", path("/state").c_str(), 1);
}

EmulatedUsb::~EmulatedUsb()
{
  g_object_unref(testbed_);
}

UMockdevTestbed *
EmulatedUsb::testbed() const
{
  return testbed_;
}

std::string
EmulatedUsb::path(const std::string &path) const
{
  char *root = umockdev_testbed_get_root_dir(testbed_);
  const std::string result = root + path;
  g_free(root);
  return result;
}

int
EmulatedUsb::next_address()
{
  return ++address_;
}

void
EmulatedUsb::bind(const std::string &syspath, int interface, bool has_driver)
{
  namespace fs = std::filesystem;
  const std::string name
      = fs::path(syspath).filename().string() + ":1." + std::to_string(interface);
  const fs::path folder = path("/sys" + syspath + "/" + name);
  fs::create_directories(folder);
  fs::remove(folder / "driver");
  if (has_driver)
    fs::create_directory_symlink("/sys/bus/usb/drivers/serial", folder / "driver");
  const fs::path link = path("/sys/bus/usb/devices/" + name);
  fs::remove(link);
  fs::create_directory_symlink(folder, link);
}

void
EmulatedUsb::stop_udev()
{
  for (const auto &entry : std::filesystem::directory_iterator(path("/")))
    if (entry.path().filename().string().starts_with("event"))
      std::filesystem::remove(entry.path());
}

bool
Urb::is_control() const
{
  return as_urb(urb)->type == USBDEVFS_URB_TYPE_CONTROL;
}

bool
Urb::is_to_host() const
{
  return (as_urb(urb)->endpoint & 0x80) != 0;
}

std::span<std::uint8_t>
Urb::bytes() const
{
  return { buffer ? buffer->data : nullptr, static_cast<std::size_t>(as_urb(urb)->buffer_length) };
}

UsbfsNode::UsbfsNode(EmulatedUsb &usb, std::string path, std::mutex &mutex, Device &device)
    : usb_(usb), path_(std::move(path)), mutex_(mutex), device_(device),
      handler_(umockdev_ioctl_base_new())
{
  link_->node = this;
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0)
    throw std::runtime_error("no pty");
  slave_ = ioctl(master_, TIOCGPTPEER, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (slave_ < 0)
    throw std::runtime_error("no pty");
  open_gate(false);

  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(handle_ioctl), this);
  g_signal_connect(handler_, "client-connected", G_CALLBACK(client_connected), this);
  umockdev_testbed_attach_ioctl(usb_.testbed(), path_.c_str(), handler_, nullptr);

  // umockdev would create a plain file, which is always ready, when the device is announced.
  const std::filesystem::path node = usb_.path(path_);
  std::filesystem::create_directories(node.parent_path());
  std::filesystem::create_symlink(ptsname(master_), node);
}

UsbfsNode::~UsbfsNode()
{
  umockdev_testbed_detach_ioctl(usb_.testbed(), path_.c_str(), nullptr);
  g_signal_handlers_disconnect_by_data(handler_, this);
  g_object_unref(handler_);
  {
    const std::lock_guard lock(link_->mutex); // waits for a client that is just leaving
    link_->node = nullptr;
  }
  for (const Urb &urb : done_)
    g_object_unref(urb.urb);
}

void
UsbfsNode::done(Urb urb, int status, std::size_t actual)
{
  urb.status = status;
  urb.actual = static_cast<int>(actual);
  done_.push_back(urb);
  if (plugged_)
    open_gate(true);
}

std::size_t
UsbfsNode::to_be_reaped() const
{
  return done_.size();
}

void
UsbfsNode::unplug()
{
  plugged_ = false;
  std::filesystem::remove(usb_.path(path_));
  close(slave_);
  close(master_); // POLLERR at the host
  slave_ = master_ = -1;
}

void
UsbfsNode::forbid()
{
  fchmod(slave_, 0);
}

gboolean
UsbfsNode::handle_ioctl(UMockdevIoctlBase *, UMockdevIoctlClient *client, UsbfsNode *node)
{
  std::optional<Answer> answer;
  {
    std::unique_lock lock(node->mutex_, std::defer_lock);
    answer = node->answer(client, umockdev_ioctl_client_get_request(client),
                          umockdev_ioctl_client_get_arg(client), lock);
    if (!lock)
      lock.lock();
    node->device_.changed();
  }
  if (!answer)
    return FALSE;
  umockdev_ioctl_client_complete(client, answer->result, answer->error);
  return TRUE;
}

void
UsbfsNode::client_connected(UMockdevIoctlBase *, UMockdevIoctlClient *client, UsbfsNode *node)
{
  g_object_weak_ref(G_OBJECT(client), client_left, new std::shared_ptr<Link>(node->link_));
}

void
UsbfsNode::client_left(gpointer data, GObject *client)
{
  const std::unique_ptr<std::shared_ptr<Link>> link(static_cast<std::shared_ptr<Link> *>(data));
  const std::lock_guard link_lock((*link)->mutex);
  UsbfsNode *node = (*link)->node;
  if (!node)
    return;
  const std::lock_guard lock(node->mutex_);
  std::erase_if(node->done_, [client](const Urb &urb) {
    if (urb.host != client)
      return false;
    g_object_unref(urb.urb);
    return true;
  });
  node->device_.host_left(client);
  node->device_.changed();
}

/// Reads the host's memory before it takes the lock, because a suspended host does not answer.
std::optional<UsbfsNode::Answer>
UsbfsNode::answer(const void *host, unsigned long request, UMockdevIoctlData *argument,
                  std::unique_lock<std::mutex> &lock)
{
  const Answer no_device{ -1, ENODEV };
  const auto enter = [&] {
    lock.lock();
    return plugged_;
  };
  switch (request) {
  case USBDEVFS_REAPURBNDELAY:
  case USBDEVFS_REAPURB: {
    UMockdevIoctlData *pointer
        = umockdev_ioctl_data_resolve(argument, 0, sizeof(gpointer), nullptr);
    lock.lock();
    const Answer answer = pointer ? reap(pointer) : Answer{ -1, EFAULT };
    g_clear_object(&pointer);
    return answer;
  }
  case USBDEVFS_GET_CAPABILITIES: {
    UMockdevIoctlData *data = umockdev_ioctl_data_resolve(argument, 0, sizeof(guint32), nullptr);
    const guint32 capabilities = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM
                                 | USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
    std::memcpy(data->data, &capabilities, sizeof capabilities);
    g_object_unref(data);
    return enter() ? Answer{} : no_device;
  }
  case USBDEVFS_DISCONNECT_CLAIM: {
    const auto claim = resolve<struct usbdevfs_disconnect_claim>(argument);
    return !enter()                                                  ? no_device
           : !claim                                                  ? Answer{ -1, EFAULT }
           : device_.claim(host, static_cast<int>(claim->interface)) ? Answer{}
                                                                     : Answer{ -1, EBUSY };
  }
  case USBDEVFS_RELEASEINTERFACE: {
    const auto interface = resolve<int>(argument);
    if (!enter())
      return no_device;
    if (!interface)
      return Answer{ -1, EFAULT };
    device_.release(*interface);
    return Answer{};
  }
  case USBDEVFS_IOCTL: {
    const auto command = resolve<struct usbdevfs_ioctl>(argument);
    if (!enter())
      return no_device;
    if (!command || command->ioctl_code != static_cast<int>(USBDEVFS_CONNECT))
      return Answer{ -1, ENOTTY };
    device_.give_back(command->ifno);
    return Answer{ 1, 0 };
  }
  case USBDEVFS_SUBMITURB: {
    Urb urb{ .host = host };
    urb.urb = umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_urb), nullptr);
    UMockdevIoctlData *buffer
        = urb.urb ? umockdev_ioctl_data_resolve(
              urb.urb, offsetof(struct usbdevfs_urb, buffer),
              static_cast<std::size_t>(as_urb(urb.urb)->buffer_length), nullptr)
                  : nullptr;
    urb.buffer = buffer; // owned by urb.urb
    g_clear_object(&buffer);
    if (enter() && urb.urb) {
      device_.submit(urb);
      return Answer{};
    }
    const Answer refused = urb.urb ? no_device : Answer{ -1, EFAULT };
    g_clear_object(&urb.urb);
    return refused;
  }
  case USBDEVFS_DISCARDURB:
    return enter() ? discard(host, argument) : no_device;
  default:
    return enter() ? Answer{ -1, ENOTTY } : no_device;
  }
}

/// `pointer` is where the host expects the address of the transfer.
UsbfsNode::Answer
UsbfsNode::reap(UMockdevIoctlData *pointer)
{
  if (done_.empty()) {
    if (!plugged_)
      return { -1, ENODEV };
    open_gate(false);
    return { -1, EAGAIN };
  }
  const Urb urb = done_.front();
  done_.pop_front();
  as_urb(urb.urb)->status = urb.status;
  as_urb(urb.urb)->actual_length = urb.actual;
  umockdev_ioctl_data_set_ptr(pointer, 0, urb.urb);
  g_object_unref(urb.urb);
  return {};
}

UsbfsNode::Answer
UsbfsNode::discard(const void *host, UMockdevIoctlData *argument)
{
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  const std::optional<Urb> urb = device_.cancel(host, address);
  if (!urb)
    return { -1, EINVAL };
  done(*urb, -ENOENT, 0);
  return {};
}

/// Whether the host's poll() reports a transfer to reap.
void
UsbfsNode::open_gate(bool open)
{
  tcflow(slave_, open ? TCOON : TCOOFF);
}

} // namespace usb_test
