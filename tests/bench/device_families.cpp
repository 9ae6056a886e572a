// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device_families.h"

#include "sound_card.h"

#include "support/boards/emulated_board.h"
#include "support/haptic_server.h"
#ifdef HAVE_GAMEPAD
#include "support/virtual_gamepad.h"
#endif

#include "synth/shaker.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <optional>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;

namespace {

using Change = Device::Change;

constexpr auto kPatience = 30s;

/// The first change from `begin` on to nearly full strength, or to zero. What a sound card does is
/// known this exactly: it may seem to precede its cause.
constexpr Time kExact = 5ms;
constexpr double kOn = 0.9;

std::optional<Change>
find(const std::vector<Change> &changes, Time begin, bool on)
{
  const auto found = std::ranges::find_if(changes, [&](const Change &change) {
    return change.at >= begin - kExact && (on ? change.level > kOn : change.level == 0);
  });
  return found == changes.end() ? std::nullopt : std::optional(*found);
}

void
assert_found(const std::optional<Change> &found, bool on)
{
  fail_unless(found.has_value(), "the motor did not go %s", on ? "on" : "off");
}

/// One that tells of each change, on any thread.
class TellingDevice : public Device
{
public:
  std::vector<Change> changes() override
  {
    const std::lock_guard lock(mutex_);
    return changes_;
  }
  Change wait_for(Time begin, bool on) override
  {
    std::unique_lock lock(mutex_);
    std::optional<Change> found;
    changed_.wait_for(lock, kPatience,
                      [&] { return (found = find(changes_, begin, on)).has_value(); });
    assert_found(found, on);
    return *found;
  }

protected:
  void add(const Change &change)
  {
    const std::lock_guard lock(mutex_);
    changes_.push_back(change);
    changed_.notify_all();
  }

private:
  std::mutex mutex_; ///< guards what follows
  std::condition_variable changed_;
  std::vector<Change> changes_;
};

/// Behind tests/support/haptic_server.py.
class ServedDevice final : public TellingDevice
{
public:
  struct Kind
  {
    const char *driver;
    const char *server;
    const char *name; ///< of the device
    double full;      ///< how the server prints level 1
  };

  ServedDevice(const Kind &kind, bool slow)
      : server_(slow ? std::vector<std::string>{ kind.server, "slow=200" }
                     : std::vector<std::string>{ kind.server },
                [this, full = kind.full](const std::string &line, auto at) {
                  if (line.starts_with("motors "))
                    add({ at.time_since_epoch(), first_of(line) / full });
                })
  {
    sink = std::string("tactorsink driver=") + kind.driver + " device=\""
           + server_.device(kind.name) + "\"";
  }

  std::vector<std::size_t> waiting() override
  {
    std::vector<std::size_t> all;
    for (const std::string &line : server_.lines("waiting "))
      all.push_back(std::stoul(line.substr(8)));
    return all;
  }

private:
  /// Of motor 0 in a line "motors WHERE 0=LEVEL ...".
  static double first_of(const std::string &line)
  {
    const std::size_t at = line.find(" 0=");
    return at == std::string::npos ? 0 : g_ascii_strtod(line.c_str() + at + 3, nullptr);
  }

  HapticServer server_;
};

#ifdef HAVE_GAMEPAD
class GamepadDevice final : public TellingDevice
{
public:
  GamepadDevice()
      : pad_("virtual pad", true, [this](int low, int) {
          add({ std::chrono::steady_clock::now().time_since_epoch(), low / 65535.0 });
        })
  {
    sink = "tactorsink driver=gamepad device=\"virtual pad\"";
  }

private:
  VirtualPad pad_;
};
#endif

/// A shaker, by what is heard of the card's left channel.
class SoundCardDevice final : public TellingDevice
{
public:
  SoundCardDevice() : card_([this](Time at, double level) { add({ at, level }); })
  {
    sink = "tactoraudiosink frequency=1000 audio-sink=\"pulsesink name=card server="
           + card_.server() + "\"";
    own = "card";
  }

private:
  SoundCard card_;
};

/// An Arduino Mega on USB.
class BoardDevice final : public Device
{
public:
  explicit BoardDevice(bool is_seat)
      : firmware_(std::make_shared<usb_test::Firmware>(kMega, is_seat)),
        board_(usb_, { .baud = 57600, .chip = 128 }, firmware_)
  {
    sink = std::string("tactorsink driver=") + (is_seat ? "seat" : "firmata");
  }

  std::vector<Change> changes() override
  {
    std::vector<Change> all;
    board_.with_firmware([&] { all = changes_of_first_pin(); });
    return all;
  }
  Change wait_for(Time begin, bool on) override
  {
    std::optional<Change> found;
    board_.wait_until(
        [&] { return (found = find(changes_of_first_pin(), begin, on)).has_value(); });
    assert_found(found, on);
    return *found;
  }

private:
  std::vector<Change> changes_of_first_pin() const
  {
    constexpr int kFirstPin = 2;
    std::vector<Change> all;
    for (const usb_test::Firmware::Change &change : firmware_->changes())
      if (change.pin == kFirstPin)
        all.push_back({ change.time.time_since_epoch(), change.duty / 255.0 });
    return all;
  }

  usb_test::EmulatedUsb usb_;
  std::shared_ptr<usb_test::Firmware> firmware_;
  usb_test::EmulatedBoard board_;
};

template <class Kind, class... Arguments>
std::function<std::unique_ptr<Device>(bool)>
maker(Arguments... arguments)
{
  return [arguments...](bool) {
    return std::make_unique<Kind>(arguments...);
  };
}

Family
served(const char *name, const ServedDevice::Kind &kind,
       const std::function<tactor::MotorModel()> &motor)
{
  return { name, false, true, true, motor, [kind](bool slow) {
            return std::make_unique<ServedDevice>(kind, slow);
          } };
}

} // namespace

std::vector<Family>
families()
{
  const auto paper = [] {
    return tactor::MotorModel();
  };
  const auto shaker = [] {
    return tactor::MotorModel(synth::shaker(25ms, kVolts)); // tactoraudiosink's default
  };
  return {
    { "Arduino, StandardFirmata", true, true, false, paper, maker<BoardDevice>(false) },
    { "Arduino, `seat`", true, true, false, paper, maker<BoardDevice>(true) },
    served("bHaptics", { "bhaptics", "bhaptics", "vest-back", 100 }, paper),
    served("Intiface, version 3", { "intiface", "buttplug3", "Test Vibrator", 1 }, paper),
    served("Intiface, version 4", { "intiface", "buttplug4", "Test Vibrator", 20 }, paper),
#ifdef HAVE_GAMEPAD
    { "gamepad", true, false, false, paper, maker<GamepadDevice>() },
#endif
    { "shaker at a sound card", true, true, false, shaker, maker<SoundCardDevice>() },
  };
}
