// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Conversations with boards over a line of 57600 baud, in virtual time.
#include "tactor/drivers/firmata_board.h"

#include "support/boards/firmata_model.h"
#include "tactor/command_planner.h"
#include "tactor/command_queue.h"
#include "tactor/serial/serial_port.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;
using State = FirmataBoard::State;

namespace {

// an Arduino's 57600 baud: 16 MHz / 8 / 35
constexpr Time kByte = Time(1s) * 10 * 35 * 8 / 16'000'000;

/// A board at the end of a line.
class Line
{
public:
  explicit Line(const Layout &layout, bool seat = false, Time boot = 0ms)
      : model(layout, seat, boot), board(0ms)
  {
    model.restart(now);
  }

  /// Advances the time up to `until`, or until `stop` returns true.
  void run_to(
      Time until, const std::function<bool()> &stop = [] { return false; })
  {
    while (!stop()) {
      if (host_runs) {
        const std::vector<std::uint8_t> bytes = board.next(now);
        ck_assert_uint_le(bytes.size(), SerialPort::kMaxWrite);
        if (!bytes.empty()) {
          fail_unless(on_the_way.empty());
          on_the_way.assign(bytes.begin(), bytes.end());
          next_out = now + kByte;
          transfers.push_back({ now, bytes.size() });
        }
      }
      Time next = Time::max();
      if (!on_the_way.empty() && line_takes)
        next = std::min(next, next_out);
      if (!model.replies.empty()) {
        next_in = std::max(next_in, now + kByte);
        next = std::min(next, next_in);
      } else {
        next_in = Time(0);
      }
      if (const auto by_itself = model.next())
        next = std::min(next, *by_itself);
      if (const auto deadline = board.deadline(); deadline && host_runs)
        next = std::min(next, *deadline);
      if (next > until)
        break;
      now = std::max(now, next);
      model.pass(now);
      if (!on_the_way.empty() && line_takes && now >= next_out) {
        model.receive(on_the_way.front(), now);
        on_the_way.pop_front();
        next_out = now + kByte;
        if (on_the_way.empty())
          board.written();
      }
      if (!model.replies.empty() && next_in > Time(0) && now >= next_in) {
        const std::uint8_t byte = model.replies.front() ^ flip(replied++);
        model.replies.pop_front();
        next_in = Time(0);
        board.received(std::span(&byte, 1));
      }
    }
    if (!stop())
      now = std::max(now, until);
  }
  void run_for(Time time)
  {
    run_to(now + time);
  }
  void connect()
  {
    run_to(10s, [this] { return board.state() != State::asking; });
    fail_unless(board.state() == State::running, "%s", board.failure().c_str());
    run_for(100ms);
  }
  void set(const std::vector<double> &levels)
  {
    board.set_levels(levels, now);
  }

  struct Transfer
  {
    Time begin;
    std::size_t bytes;
  };

  FirmataModel model;
  FirmataBoard board;
  Time now{ 0 };
  std::deque<std::uint8_t> on_the_way;
  std::vector<Transfer> transfers;
  bool host_runs = true;  ///< false: the process is stopped
  bool line_takes = true; ///< false: an endpoint is stalled
  std::function<std::uint8_t(std::size_t)> flip = [](std::size_t) {
    return std::uint8_t{ 0 };
  }; ///< bits to flip in the board's nth byte
  std::size_t replied = 0;

private:
  Time next_out{ 0 };
  Time next_in{ 0 };
};

int
duty(double level, int bits = 8)
{
  return static_cast<int>(std::lround(level * ((1 << bits) - 1)));
}

} // namespace

/// A Mega that DTR resets is silent for 2.1 s. One that keeps running sent its banner long ago.
/// Both are ready soon after they can answer: 683 bytes take 119 ms.
CHECK_TEST(test_handshake)
{
  for (const Time boot : { 0ms, 300ms, 2100ms, 4000ms })
    for (const bool banner : { true, false }) {
      Line line(kMega, false, boot);
      if (!banner)
        line.model.replies.clear();
      line.run_to(10s, [&] { return line.board.state() != State::asking; });
      fail_unless(line.board.state() == State::running);
      fail_unless(line.now < boot + 1300ms, "%d ms", static_cast<int>(line.now / 1ms));
      fail_unless(line.board.firmware() == "StandardFirmata.ino 2.5");
      fail_if(line.board.has_watchdog());
      fail_unless(line.board.pins()
                  == (std::vector{ 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46 }));
      fail_unless(line.board.resolution() == 1.0 / 255);
      line.run_for(100ms);
      for (const int pin : line.board.pins())
        fail_unless(line.model.mode[pin] == 3);
      fail_unless(line.model.mode.size() == 15);
      fail_unless(line.model.is_silent());
    }
}

/// The last host was killed, so motors run. The board has USB of its own and does not reset when it
/// is opened. Motors stop before the host asks for anything.
CHECK_TEST(test_motors_left_on)
{
  Line line(kUno);
  line.run_to(1ms);
  for (const int byte : { 0xf4, 3, 3, 0xe3, 0x40, 1, 0xf0, 0x6f, 5 })
    line.model.receive(static_cast<std::uint8_t>(byte), line.now);
  ck_assert_int_eq(line.model.duty[3], 192);
  line.connect();
  fail_unless(line.model.is_silent());
  ck_assert_int_eq(line.model.resets, 1);
}

CHECK_TEST(test_time_of_an_update)
{
  Line mega(kMega);
  mega.connect();
  // 12 pins below 16 take 3 bytes each, the other 3 take 6
  fail_unless(mega.board.line().all() == 54 * kByte);
  Line uno(kUno);
  uno.connect();
  fail_unless(uno.board.line().all() == 18 * kByte);

  // On the line, 9 tactors take 27 bytes.
  mega.set(std::vector<double>(9, 1.0));
  const Time begin = mega.now;
  mega.run_to(begin + 1s, [&] { return mega.model.duty[10] == 255; });
  fail_unless(mega.now == begin + 27 * kByte);
  ck_assert_uint_eq(mega.transfers.back().bytes, 27);
}

/// Latest wins: one transfer carries only the tactors that changed. A write during a transfer only
/// replaces the target.
CHECK_TEST(test_latest_wins)
{
  Line line(kUno);
  line.connect();
  line.set({ 1.0, 0.5, 0.25 });
  line.run_for(20ms);
  fail_unless(
      line.model.duty
      == (std::map<int, int>{ { 3, 255 }, { 5, 128 }, { 6, 64 }, { 9, 0 }, { 10, 0 }, { 11, 0 } }));
  const std::size_t before = line.model.received.size();
  const std::size_t transfers = line.transfers.size();
  line.set({ 1.0, 0.6, 0.25 });
  line.run_for(kByte);
  for (int i = 0; i < 50; i++)
    line.set({ i / 100.0, 0.6, 0.25, 0, 0, i / 50.0 });
  line.set({ 0.2, 0.6, 0.25 });
  line.run_for(20ms);
  ck_assert_uint_eq(line.transfers.size(), transfers + 2);
  const std::vector<std::uint8_t> sent(
      line.model.received.begin() + static_cast<std::ptrdiff_t>(before), line.model.received.end());
  fail_unless(sent == (std::vector<std::uint8_t>{ 0xe5, 153 & 127, 1, 0xe3, 51, 0 }));
  line.set({ 0.2, 0.6, 0.25 });
  line.run_for(20ms);
  ck_assert_uint_eq(line.transfers.size(), transfers + 2);
}

/// 300 on a pin of 8 bits would wrap to 44. NaN counts as zero.
CHECK_TEST(test_levels_are_clipped)
{
  Layout fine = kUno;
  fine.pwm_bits = 12;
  Layout finest = kUno;
  finest.pwm_bits = 16;
  for (const Layout &layout : { kUno, fine, finest }) {
    Line line(layout);
    line.connect();
    const int full = (1 << layout.pwm_bits) - 1;
    line.set({ 300.0 / 255, 1e300, -1, std::nan(""), INFINITY, 0.3, 1, 1, 1 });
    line.run_for(20ms);
    fail_unless(line.model.duty
                == (std::map<int, int>{ { 3, full },
                                        { 5, full },
                                        { 6, 0 },
                                        { 9, 0 },
                                        { 10, full },
                                        { 11, duty(0.3, layout.pwm_bits) } }));
    fail_unless(line.board.resolution() == 1.0 / full);
  }
}

/// Commands of a film, from the planner. Each pin goes through the planned duties in their order:
/// it may skip some, but gets no others. The last one arrives within two updates: the one in flight
/// and its own.
CHECK_TEST(test_planned_commands_arrive)
{
  for (const unsigned seed : { 1u, 2u, 3u }) {
    std::mt19937 random(seed);
    Line line(kMega);
    line.connect();
    const Time origin = line.now;
    CommandPlanner planner(9, { .rate = 0, .transport_latency = line.board.line().all() });
    CommandQueue queue(9);
    std::vector<std::vector<int>> planned(9, { 0 });
    const std::vector<int> pins = line.board.pins();
    for (int frame = 0; frame < 300; frame++) {
      std::vector<float> levels(9);
      for (float &level : levels)
        level = static_cast<float>(random() % 5) / 4.0f;
      queue.push(planner.plan(1s + frame * 33ms, 33ms, levels));
      while (queue.next_due() && *queue.next_due() <= 800ms + frame * 33ms) {
        const Time due = *queue.next_due();
        line.run_to(origin + due);
        queue.take_due(due);
        std::vector<double> targets;
        for (std::size_t i = 0; i < 9; i++) {
          targets.push_back(queue.levels()[i] / 3.0);
          planned[i].push_back(duty(targets[i]));
        }
        line.set(targets);
        if (const auto next = queue.next_due();
            !next || *next >= due + 2 * line.board.line().all()) {
          line.run_to(origin + due + 2 * line.board.line().all());
          for (std::size_t i = 0; i < 9; i++)
            ck_assert_int_eq(line.model.duty[pins[i]], planned[i].back());
        }
      }
    }
    line.run_for(50ms);
    // The duties of each pin, from the bytes. After the set-up all of them are analog messages.
    std::vector<std::size_t> at(9, 0);
    const auto &bytes = line.model.received;
    const auto first = static_cast<std::size_t>(std::ranges::find(bytes, 0xf4) - bytes.begin()
                                                + (12 * 6 + 3 * 9));
    ck_assert_uint_gt(bytes.size(), first + 3000);
    for (std::size_t i = first; i < bytes.size(); i += 3) {
      fail_unless((bytes[i] & 0xf0) == 0xe0);
      const std::size_t tactor = (bytes[i] & 0x0fu) - 2u;
      ck_assert_uint_lt(tactor, 9);
      const int value = bytes[i + 1] | bytes[i + 2] << 7;
      while (at[tactor] < planned[tactor].size() && planned[tactor][at[tactor]] != value)
        at[tactor]++;
      ck_assert_uint_lt(at[tactor], planned[tactor].size());
    }
    for (std::size_t i = 0; i < 9; i++)
      ck_assert_int_eq(line.model.duty[pins[i]], planned[i].back());
  }
}

/// A chair whose levels take more than one transfer.
CHECK_TEST(test_many_pins)
{
  Layout many{ .name = "many",
               .pins = 128,
               .first_digital = 0,
               .first_analog = 128,
               .pwm = {},
               .i2c = {},
               .pwm_bits = 16 };
  for (int pin = 0; pin < 128; pin++)
    many.pwm.insert(pin);
  Line line(many);
  line.connect();
  line.run_for(1s);
  line.set(std::vector<double>(128, 1.0));
  line.run_for(240ms);
  for (int pin = 0; pin < 128; pin++)
    ck_assert_int_eq(line.model.duty[pin], 65535);
  line.board.close(line.now);
  line.run_for(240ms);
  fail_unless(line.board.state() == State::closed);
  fail_unless(line.model.duty.empty());
  ck_assert_int_eq(line.model.resets, 2);
}

/// Zeros, then a reset, also during a transfer and while the board boots.
CHECK_TEST(test_close)
{
  for (const int bytes_before : { 0, 1, 2, 3, 5, 18, 100 }) {
    Line line(kUno);
    line.connect();
    line.set(std::vector<double>(6, 0.8));
    line.run_for(bytes_before * kByte);
    line.board.close(line.now);
    line.set(std::vector<double>(6, 1.0)); // too late
    line.run_for(20ms);
    fail_unless(line.board.state() == State::closed);
    fail_unless(line.model.is_silent());
    const auto &bytes = line.model.received;
    const std::vector<std::uint8_t> last(bytes.end() - (bytes_before > 0 ? 5 : 2), bytes.end());
    fail_unless(last
                == (bytes_before > 0 ? std::vector<std::uint8_t>{ 0xeb, 0, 0, 0xff, 0xf9 }
                                     : std::vector<std::uint8_t>{ 0xff, 0xf9 }));
    fail_if(line.board.deadline().has_value());
  }
  Line line(kUno, false, 2s);
  line.run_for(1s);
  line.board.close(line.now);
  line.run_for(10s);
  fail_unless(line.board.state() == State::closed);
  fail_unless(line.model.received.empty());
}

/// A line that stalls blocks nobody.
CHECK_TEST(test_stalled_line)
{
  Line line(kUno);
  line.connect();
  line.line_takes = false;
  line.set({ 1.0 });
  const Time begin = line.now;
  line.run_to(begin + 10s, [&] { return line.board.state() == State::failed; });
  fail_unless(line.now == begin + 1s);
  fail_unless(line.board.failure().find("does not take") != std::string::npos);

  Line closing(kUno);
  closing.connect();
  closing.line_takes = false;
  closing.set({ 1.0 });
  closing.run_for(1ms);
  const Time close = closing.now;
  closing.board.close(close);
  closing.run_to(close + 10s, [&] { return closing.board.state() == State::closed; });
  fail_unless(closing.now == close + 250ms);
}

/// The board fails after 5 s. The reason names the last answer that was missing.
CHECK_TEST(test_board_that_does_not_answer)
{
  const auto failure = [](Line &line) {
    line.run_to(60s, [&] { return line.board.state() != State::asking; });
    fail_unless(line.board.state() == State::failed);
    fail_unless(line.now == 5s);
    fail_if(line.board.deadline().has_value());
    return line.board.failure();
  };
  Line silent(kUno, false, 1h);
  fail_unless(failure(silent).find("does not answer") != std::string::npos);
  ck_assert_uint_eq(silent.transfers.size(), 10); // every 500 ms

  Line noise(kUno);
  noise.flip = [](std::size_t) {
    return std::uint8_t{ 0x55 };
  };
  fail_unless(failure(noise).find("57600 baud") != std::string::npos);

  // The capabilities are cut short each time, so the host asks until the end.
  Line short_replies(kMega);
  short_replies.flip = [&](std::size_t) {
    const bool in_capabilities
        = short_replies.model.replies.size() < 10 && !short_replies.board.firmware().empty();
    return in_capabilities ? std::uint8_t{ 0x80 } : std::uint8_t{ 0 };
  };
  fail_unless(failure(short_replies).find("what its pins can do") != std::string::npos);
}

/// Damage at any byte of a reply costs at most one more question, and no pin is invented.
CHECK_TEST(test_garbled_reply)
{
  std::mt19937 random(3);
  int garbled = 0;
  for (std::size_t at = 0; at < 740; at += 1 + random() % 3) {
    Line line(kMega);
    const auto damage = static_cast<std::uint8_t>(0x80 | (random() & 0x7f));
    line.flip = [=](std::size_t byte) {
      return byte == at ? damage : std::uint8_t{ 0 };
    };
    line.run_to(10s, [&] { return line.board.state() != State::asking; });
    fail_unless(line.board.state() == State::running, "byte %zu", at);
    fail_unless(line.now < 1800ms);
    ck_assert_uint_eq(line.board.pins().size(), 15);
    garbled += line.transfers.size() > 2;
  }
  ck_assert_int_gt(garbled, 200);
}

/// A board that resets itself, by its button or a voltage drop, gets all levels again.
CHECK_TEST(test_board_resets_itself)
{
  Line line(kMega, false, 2100ms);
  line.connect();
  line.set({ 0.5, 1.0 });
  line.run_for(50ms);
  line.model.restart(line.now);
  for (int i = 0; i < 30; i++) {
    line.set({ 0.5, i < 10 ? 0.2 : 0.7 });
    line.run_for(100ms);
  }
  ck_assert_int_eq(line.model.duty[2], 128);
  ck_assert_int_eq(line.model.duty[3], 179);
  ck_assert_uint_eq(line.board.resets(), 1);
}

/// The thread that sets levels hangs: after 250 ms all motors are off with any firmware. When it
/// resumes, so do they.
CHECK_TEST(test_host_falls_silent)
{
  for (const bool seat : { false, true }) {
    Line line(kUno, seat);
    line.connect();
    for (int i = 0; i < 20; i++) {
      line.set({ 0.5, 1.0 });
      line.run_for(240ms);
      fail_if(line.model.is_silent());
    }
    const Time set = line.now;
    line.set({ 0.5, 0.9 });
    line.run_to(set + 249ms);
    ck_assert_int_eq(line.model.duty[3], 128);
    line.run_to(set + 252ms); // six bytes
    fail_unless(line.model.is_silent());
    const std::size_t transfers = line.transfers.size();
    line.run_for(10s);
    ck_assert_uint_eq(line.transfers.size(), transfers);
    line.set({ 0.5, 0.9 });
    line.run_for(5ms);
    ck_assert_int_eq(line.model.duty[5], duty(0.9));
    ck_assert_int_eq(line.model.trips, 0);
  }
}

/// The whole process is killed or stopped: only the watchdog stops the motors. A process that
/// resumes sends all levels again.
CHECK_TEST(test_process_is_stopped)
{
  for (const bool seat : { false, true }) {
    Line line(kUno, seat);
    line.connect();
    fail_unless(line.board.has_watchdog() == seat);
    line.set({ 0.5, 1.0 });
    line.run_for(10ms);
    line.host_runs = false;
    line.run_for(240ms);
    ck_assert_int_eq(line.model.duty[5], 255);
    line.run_for(5s);
    fail_unless(line.model.is_silent() == seat);
    ck_assert_int_eq(line.model.trips, seat ? 1 : 0);
    line.host_runs = true;
    line.set({ 0.5, 1.0 });
    line.run_for(10ms);
    ck_assert_int_eq(line.model.duty[3], 128);
    ck_assert_int_eq(line.model.duty[5], 255);
  }
}

/// Keepalives every 100 ms while a motor is on, none otherwise. The watchdog never trips during a
/// film, nor in its pauses.
CHECK_TEST(test_keepalive)
{
  Line line(kUno, true);
  line.connect();
  ck_assert_int_eq(line.model.keepalives, 1); // arms it
  line.run_for(10s);
  ck_assert_int_eq(line.model.keepalives, 1);
  const Time begin = line.now;
  while (line.now < begin + 1s) {
    line.set({ 0.5 });
    line.run_for(50ms);
  }
  ck_assert_int_ge(line.model.keepalives, 10);
  ck_assert_int_le(line.model.keepalives, 11);
  std::mt19937 random(9);
  for (int i = 0; i < 1000; i++) {
    const double level = static_cast<double>(random() % 3) / 2;
    for (unsigned j = random() % 4; j > 0; j--) {
      line.set({ level, 1 - level });
      line.run_for(100ms);
      ck_assert_int_eq(line.model.duty[3], duty(level));
      ck_assert_int_eq(line.model.duty[5], duty(1 - level));
    }
    line.set({});
    line.run_for(5ms + random() % 600 * 1ms);
    fail_unless(line.model.is_silent());
  }
  ck_assert_int_eq(line.model.trips, 0);
}

CHECK_MAIN(firmata_board)
