// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Device trees as Linux 6.1 has them. A terminal of cdc_acm belongs to the device's interface, one
// of usb-serial to a port of it.
#include "tactor/serial/tty_use.h"

#include "system_tree.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

using namespace tactor;
using Kind = LineUse::Kind;

namespace {

/// A terminal of its own, which stands for a serial line's.
class Pty
{
public:
  Pty() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC))
  {
    fail_unless(master_ >= 0 && grantpt(master_) == 0 && unlockpt(master_) == 0);
    node = ptsname(master_);
    struct stat status
    {
    };
    fail_unless(stat(node.c_str(), &status) == 0);
    number = std::to_string(major(status.st_rdev)) + ":" + std::to_string(minor(status.st_rdev));
  }
  ~Pty()
  {
    close(master_);
  }
  Pty(const Pty &) = delete;
  Pty &operator=(const Pty &) = delete;

  std::string node;
  std::string number; ///< as "136:3"

private:
  int master_;
};

/// A machine with USB serial lines.
struct Machine : SystemTree
{
  Machine()
  {
    refs("cdc_acm", 0);
    refs("ftdi_sio", 0);
    refs("usbserial", 1); // in use by ftdi_sio
  }
  void refs(const std::string &module, int count) const
  {
    write(roots.sys / "module" / module / "refcnt", std::to_string(count) + "\n");
  }
  /// Adds a line like ttyACM0.
  void plug_acm(const std::string &bus_path, const std::string &name, const Pty &pty) const
  {
    const auto interface = roots.sys / "devices/usb1" / bus_path / (bus_path + ":1.0");
    add(interface, interface / "tty" / name, name, pty.number);
    driver(interface, "usb/drivers/cdc_acm", "cdc_acm");
  }
  /// Adds a line like ttyUSB0.
  void plug_ftdi(const std::string &bus_path, const std::string &name, const Pty &pty) const
  {
    const auto interface = roots.sys / "devices/usb1" / bus_path / (bus_path + ":1.0");
    add(interface / name, interface / name / "tty" / name, name, pty.number);
    driver(interface / name, "usb-serial/drivers/ftdi_sio", "ftdi_sio");
    driver(interface, "usb/drivers/ftdi_sio", "usbserial");
  }
  /// Adds a process that has this file open.
  void run(const std::string &pid, const std::string &name, const std::string &file) const
  {
    write(roots.proc / pid / "comm", name + "\n");
    link("socket:[12345]", roots.proc / pid / "fd/0");
    link(file, roots.proc / pid / "fd/3");
  }

private:
  void add(const std::filesystem::path &device, const std::filesystem::path &tty,
           const std::string &name, const std::string &number) const
  {
    write(tty / "dev", number + "\n");
    link(device, tty / "device");
    link(tty, roots.sys / "class/tty" / name);
  }
  void driver(const std::filesystem::path &device, const std::string &driver,
              const std::string &module) const
  {
    const auto folder = roots.sys / "bus" / driver;
    std::filesystem::create_directories(folder);
    if (!std::filesystem::exists(folder / "module"))
      link(roots.sys / "module" / module, folder / "module");
    link(folder, device / "driver");
  }
};

} // namespace

CHECK_TEST(test_free)
{
  const Machine machine;
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
  const Pty pty;
  machine.plug_acm("1-1", "ttyACM0", pty);
  machine.run("77", "bash", "/dev/null");
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
  // A console has no device. sysfs may be missing.
  machine.write(machine.roots.sys / "class/tty/tty1/dev", "4:1\n");
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
  fail_unless(tty_use("1-1", 0, { .sys = "/nowhere", .proc = "/nowhere" }) == LineUse{});
}

/// The error names the process. Files are compared by device number, whatever the node is called.
/// Only the line of this device counts.
CHECK_TEST(test_open)
{
  for (const bool acm : { true, false }) {
    const Machine machine;
    const Pty pty;
    const Pty other;
    const std::string name = acm ? "ttyACM0" : "ttyUSB0";
    if (acm)
      machine.plug_acm("1-1", name, pty);
    else
      machine.plug_ftdi("1-1", name, pty);
    machine.plug_ftdi("1-10", "ttyUSB7", other);
    machine.run("4242", "cat", pty.node);
    const LineUse use = tty_use("1-1", 0, machine.roots);
    fail_unless(use.kind == Kind::certain);
    fail_unless(use.by == "cat (process 4242) has " + name + " open", "%s", use.by.c_str());
    fail_unless(tty_use("1-10", 0, machine.roots) == LineUse{});
    // The chip's second line is a different one.
    fail_unless(tty_use("1-1", 1, machine.roots) == LineUse{});
  }
}

/// A process of another user: its open files are hidden, but its module's reference count is not.
CHECK_TEST(test_open_by_another_user)
{
  for (const bool acm : { true, false }) {
    const Machine machine;
    const Pty pty;
    const Pty other;
    const char *module = acm ? "cdc_acm" : "ftdi_sio";
    const auto plug = [&](const char *bus_path, const char *name, const Pty &line) {
      acm ? machine.plug_acm(bus_path, name, line) : machine.plug_ftdi(bus_path, name, line);
    };
    plug("1-1", "ttyX0", pty);
    machine.refs(module, 1);
    fail_unless(tty_use("1-1", 0, machine.roots).kind == Kind::certain);
    // One of two lines is open, and it is unknown which.
    plug("1-2", "ttyX1", other);
    fail_unless(tty_use("1-1", 0, machine.roots).kind == Kind::perhaps);
    // The other line is: its process can be seen.
    machine.run("4242", "minicom", other.node);
    fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
    machine.refs(module, 2);
    fail_unless(tty_use("1-1", 0, machine.roots).kind == Kind::certain);
  }
}

/// UUCP-style lock files count while their process lives.
CHECK_TEST(test_locks)
{
  const Machine machine;
  const Pty pty;
  machine.plug_ftdi("1-1", "ttyUSB0", pty);
  const auto lock = machine.roots.locks / "LCK..ttyUSB0";
  machine.write(lock, "      4242 minicom root\n");
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
  machine.run("4242", "minicom", "/dev/null");
  const LineUse use = tty_use("1-1", 0, machine.roots);
  fail_unless(use.kind == Kind::certain);
  ck_assert_str_eq(use.by.c_str(), "minicom (process 4242) has locked ttyUSB0");
  for (const char *nonsense :
       { "", "\n", "self", "-1", "4242x", "99999999999999999999", "../4242" }) {
    machine.write(lock, nonsense);
    fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{}, "%s", nonsense);
  }
}

/// Processes of the real machine: this one opens a terminal and closes it.
CHECK_TEST(test_processes_of_this_machine)
{
  Machine machine;
  const Pty pty;
  machine.plug_acm("1-1", "ttyACM0", pty);
  machine.roots.proc = "/proc";
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
  const int fd = open(pty.node.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  fail_unless(fd >= 0);
  const LineUse use = tty_use("1-1", 0, machine.roots);
  close(fd);
  fail_unless(use.kind == Kind::certain);
  fail_unless(use.by.ends_with("(process " + std::to_string(getpid()) + ") has ttyACM0 open"), "%s",
              use.by.c_str());
  fail_unless(tty_use("1-1", 0, machine.roots) == LineUse{});
}

/// As the kernel does it: an interface has a link to its driver or none. Nothing is known of a
/// device that is gone.
CHECK_TEST(test_without_driver)
{
  const Machine machine;
  const auto devices = machine.roots.sys / "bus/usb/devices";
  machine.write(devices / "1-1/bConfigurationValue", "2\n");
  fail_if(has_no_driver("1-1", 0, machine.roots));
  machine.write(devices / "1-1:2.0/bInterfaceNumber", "00\n");
  machine.write(devices / "1-1:2.1/bInterfaceNumber", "01\n");
  machine.link(machine.roots.sys / "bus/usb/drivers/usbhid", devices / "1-1:2.1/driver");
  fail_unless(has_no_driver("1-1", 0, machine.roots));
  fail_if(has_no_driver("1-1", 1, machine.roots));
  fail_if(has_no_driver("1-1", 2, machine.roots));
  fail_if(has_no_driver("1-2", 0, machine.roots));
}

CHECK_MAIN(tty_use)
