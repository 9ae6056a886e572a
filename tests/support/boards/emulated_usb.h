// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace usb_test {

/// Prepares a test program. Ignores SIGHUP: the pty behind a device node becomes the controlling
/// terminal of a session leader and hangs up when the board is unplugged. Makes warnings fatal,
/// except those of umockdev, which destroys clients that another thread still serves.
void begin_emulation();

/// The USB ports of an emulated machine, on which no tactor board is known yet. The process must
/// run under umockdev-wrapper. Child processes see the same ports, and know the same boards.
class EmulatedUsb
{
public:
  EmulatedUsb();
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb &) = delete;
  EmulatedUsb &operator=(const EmulatedUsb &) = delete;

  UMockdevTestbed *testbed() const;
  std::string path(const std::string &path) const; ///< real path of an emulated one
  int next_address();

  /// Whether a kernel driver is bound to an interface, as in sysfs.
  void bind(const std::string &syspath, int interface, bool has_driver);

  /// Stops udevd's events for current listeners.
  void stop_udev();

private:
  UMockdevTestbed *testbed_;
  int address_ = 1;
};

/// A submitted transfer.
struct Urb
{
  UMockdevIoctlData *urb = nullptr;    ///< owned
  UMockdevIoctlData *buffer = nullptr; ///< owned by `urb`
  const void *host = nullptr;          ///< identifies an opening of the node
  int status = 0;
  int actual = 0;

  bool is_control() const;
  bool is_to_host() const;
  std::span<std::uint8_t> bytes() const;
};

/// A usbfs device node (linux/usbdevice_fs.h), from plug to unplug: a symbolic link to a pty.
/// umockdev forwards its ioctls. The pty's flow control signals that a transfer can be reaped, its
/// hang-up that the device was unplugged.
class UsbfsNode
{
public:
  /// The device behind the node. Called with its lock held.
  class Device
  {
  public:
    virtual bool claim(const void *host, int interface) = 0; ///< false if busy
    virtual void release(int interface) = 0;
    virtual void give_back(int interface) = 0; ///< to the kernel's driver
    virtual void submit(const Urb &urb) = 0;
    /// The host discards the transfer at this address.
    virtual std::optional<Urb> cancel(const void *host, gulong address) = 0;
    /// The host closed the node or died: discards its transfers.
    virtual void host_left(const void *host) = 0;
    virtual void changed() = 0; ///< after each of the above

  protected:
    ~Device() = default;
  };

  /// `path` is emulated. Throws std::runtime_error.
  UsbfsNode(EmulatedUsb &usb, std::string path, std::mutex &mutex, Device &device);
  /// The caller does not hold the lock. umockdev must have finished with the node.
  ~UsbfsNode();
  UsbfsNode(const UsbfsNode &) = delete;
  UsbfsNode &operator=(const UsbfsNode &) = delete;

  // The caller holds the lock.
  /// Completes a transfer with a negative errno or 0, and its length.
  void done(Urb urb, int status, std::size_t actual);
  std::size_t to_be_reaped() const;
  void unplug();
  void forbid(); ///< denies opening, except to root

private:
  struct Answer
  {
    long result = 0;
    int error = 0;
  };

  /// Shared by the node and its openings, which umockdev closes from a thread of its own, possibly
  /// after the node.
  struct Link
  {
    std::mutex mutex;
    UsbfsNode *node = nullptr;
  };

  static gboolean handle_ioctl(UMockdevIoctlBase *handler, UMockdevIoctlClient *client,
                               UsbfsNode *node);
  static void client_connected(UMockdevIoctlBase *handler, UMockdevIoctlClient *client,
                               UsbfsNode *node);
  static void client_left(gpointer link, GObject *client);
  /// Locks for the caller.
  std::optional<Answer> answer(const void *host, unsigned long request, UMockdevIoctlData *argument,
                               std::unique_lock<std::mutex> &lock);
  Answer reap(UMockdevIoctlData *pointer);
  Answer discard(const void *host, UMockdevIoctlData *argument);
  void open_gate(bool open);

  EmulatedUsb &usb_;
  const std::string path_;
  std::mutex &mutex_; ///< the device's
  Device &device_;
  UMockdevIoctlBase *handler_;
  bool plugged_ = true;
  int master_ = -1;
  int slave_ = -1;
  std::deque<Urb> done_;
  std::shared_ptr<Link> link_ = std::make_shared<Link>();
};

} // namespace usb_test
