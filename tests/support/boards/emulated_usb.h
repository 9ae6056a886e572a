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

/// What a test program begins with: hang-ups are nobody's (the pty behind a device node becomes the
/// controlling terminal of a test that leads its session, and hangs up when a board is unplugged),
/// and warnings are errors, but for those of umockdev itself, which tears its clients down in one
/// thread while another still serves them.
void begin_emulation();

/// The USB ports of an emulated machine. The process must run under umockdev-wrapper; processes
/// that it starts have the same ports.
class EmulatedUsb
{
public:
  EmulatedUsb();
  ~EmulatedUsb();
  EmulatedUsb(const EmulatedUsb &) = delete;
  EmulatedUsb &operator=(const EmulatedUsb &) = delete;

  UMockdevTestbed *testbed() const;
  std::string
  path(const std::string &path) const; ///< where a path of the emulated machine really is
  int next_address();

  /// As in sysfs: an interface of a device has a driver of the kernel's, or it has none.
  void bind(const std::string &syspath, int interface, bool has_driver);

  /// udevd falls silent: nobody who listens now hears of what is plugged in or out.
  void stop_udev();

private:
  UMockdevTestbed *testbed_;
  int address_ = 1;
};

/// A transfer that a host has submitted.
struct Urb
{
  UMockdevIoctlData *urb = nullptr;    ///< owned
  UMockdevIoctlData *buffer = nullptr; ///< owned by the one above
  const void *host = nullptr;          ///< who: one opening of the node
  int status = 0;
  int actual = 0;

  bool is_control() const;
  bool is_to_host() const;
  std::span<std::uint8_t> bytes() const;
};

/// A device node as usbfs has it (linux/usbdevice_fs.h), from plugging in to plugging out: a
/// symbolic link to a pty. umockdev hands its ioctls over, the pty's flow control says when there
/// is something to reap, its hang-up is the unplugging.
class UsbfsNode
{
public:
  /// The device behind it. Called with its lock held.
  class Device
  {
  public:
    virtual bool claim(const void *host, int interface) = 0; ///< false: it is busy
    virtual void release(int interface) = 0;
    virtual void give_back(int interface) = 0; ///< to the kernel's driver
    virtual void submit(const Urb &urb) = 0;
    /// The host wants a transfer of this address back: it is forgotten.
    virtual std::optional<Urb> cancel(const void *host, gulong address) = 0;
    /// The host has closed the node, or its process is dead: its transfers are forgotten.
    virtual void host_left(const void *host) = 0;
    virtual void changed() = 0; ///< after each of the above

  protected:
    ~Device() = default;
  };

  /// `path` is the emulated machine's. Throws std::runtime_error.
  UsbfsNode(EmulatedUsb &usb, std::string path, std::mutex &mutex, Device &device);
  /// Without the lock; umockdev must not be at work for it any more.
  ~UsbfsNode();
  UsbfsNode(const UsbfsNode &) = delete;
  UsbfsNode &operator=(const UsbfsNode &) = delete;

  // With the lock held.
  /// A transfer is over, with a negative errno or 0, and so many bytes: the host may reap it.
  void done(Urb urb, int status, std::size_t actual);
  std::size_t to_be_reaped() const;
  void unplug();
  void forbid(); ///< nobody may open it any more; root still may

private:
  struct Answer
  {
    long result = 0;
    int error = 0;
  };

  /// Between the node and those that have it open, which umockdev lets go in a thread of its own,
  /// maybe after the node.
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
  /// Takes the lock, which it leaves to the caller.
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
