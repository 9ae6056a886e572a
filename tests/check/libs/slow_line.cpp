// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Chairs with many tactors for their line, in virtual time. The USB serial chip accepts bytes at
// once and sends them at the line's rate. No command can overtake what it holds, so its queue must
// stay nearly empty.
#include "tactor/command_planner.h"
#include "tactor/command_queue.h"
#include "tactor/drivers/firmata_board.h"
#include "tactor/soft_start.h"

#include "support/boards/firmata_model.h"
#include "unlimited.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <random>
#include <vector>

#include "support/check_tests.h"

using namespace std::chrono_literals;
using namespace tactor;

namespace {

// an Arduino's 57600 baud: 16 MHz / 8 / 35
constexpr Time kByte = Time(1s) * 10 * 35 * 8 / 16'000'000;

/// Pins from 2 on. With 64 tactors, 14 levels take 3 bytes and 50 take 6: 342 bytes or 59.85 ms.
Layout
chair(int tactors)
{
  Layout layout{ .name = "chair",
                 .pins = 2 + tactors,
                 .first_digital = 2,
                 .first_analog = 2 + tactors,
                 .pwm = {},
                 .i2c = {} };
  for (int pin = 2; pin < layout.pins; pin++)
    layout.pwm.insert(pin);
  return layout;
}

int
level_bytes(const Layout &layout)
{
  return std::accumulate(layout.pwm.begin(), layout.pwm.end(), 0,
                         [](int sum, int pin) { return sum + (pin < 16 ? 3 : 6); });
}

int
duty(double level)
{
  return static_cast<int>(std::lround(level * 255));
}

/// A board behind a chip that completes a write once the remaining bytes fit into its memory.
class Chip
{
public:
  explicit Chip(const Layout &layout, std::size_t memory = 128, bool seat = false)
      : model(layout, seat), board(0ms), memory_(memory)
  {
    model.restart(now);
    run_to(10s, [this] { return board.state() != FirmataBoard::State::asking; });
    fail_unless(board.state() == FirmataBoard::State::running);
    run_to(now + 1s); // modes and zeros
    most_under_way = 0;
  }

  void run_to(
      Time until, const std::function<bool()> &stop = [] { return false; })
  {
    while (!stop()) {
      const std::vector<std::uint8_t> bytes = board.next(now);
      if (stop())
        break;
      if (!bytes.empty()) {
        if (under_way_.empty())
          carried_ = now + kByte;
        under_way_.insert(under_way_.end(), bytes.begin(), bytes.end());
        most_under_way = std::max(most_under_way, under_way_.size());
        is_taken_ = false;
      }
      if (!is_taken_ && under_way_.size() <= memory_) {
        is_taken_ = true;
        board.written();
        continue;
      }
      if (!model.replies.empty()) { // takes no time: the other direction is another wire
        if (is_heard)
          board.received(std::span(&model.replies.front(), 1));
        model.replies.pop_front();
        continue;
      }
      Time next = under_way_.empty() ? Time::max() : carried_;
      for (const std::optional<Time> &at : { model.next(), board.deadline() })
        next = std::min(next, at.value_or(Time::max()));
      if (next > until)
        break;
      now = std::max(now, next);
      model.pass(now);
      if (!under_way_.empty() && now >= carried_) {
        model.receive(under_way_.front(), now);
        under_way_.pop_front();
        carried_ = now + kByte;
      }
    }
    if (!stop())
      now = std::max(now, until);
  }

  void set(const std::vector<double> &levels)
  {
    board.set_levels(levels, now);
  }

  bool has(const std::vector<double> &levels)
  {
    const std::vector<int> pins = board.pins();
    for (std::size_t i = 0; i < levels.size(); i++)
      if (model.duty[pins[i]] != duty(levels[i]))
        return false;
    return true;
  }

  /// No bytes are on the line or in the chip.
  bool is_carried() const
  {
    return under_way_.empty();
  }

  FirmataModel model;
  FirmataBoard board;
  Time now{ 0 };
  bool is_heard = true;           ///< false: the board's replies are lost
  std::size_t most_under_way = 0; ///< bytes

private:
  std::size_t memory_;
  std::deque<std::uint8_t> under_way_;
  Time carried_{ 0 }; ///< when the first of them is on the board
  bool is_taken_ = true;
};

} // namespace

/// All levels change faster than the line carries them. However much the chip accepts, at most one
/// update and a keepalive are in flight. The last levels arrive one update after they are set,
/// behind the packet in flight.
CHECK_TEST(test_nothing_queues)
{
  for (const int tactors : { 64, 9 })
    for (const std::size_t memory : { 4096u, 128u, 0u })
      for (const Time every : { 1ms, 4ms, 20ms, 59ms, 61ms })
        for (const bool seat : { false, true }) {
          const Layout layout = chair(tactors);
          const int update = level_bytes(layout);
          Chip chip(layout, memory, seat);
          std::vector<double> levels(layout.pwm.size());
          std::mt19937 random(5);
          for (const Time end = chip.now + 1s; chip.now < end; chip.run_to(chip.now + every)) {
            for (double &level : levels)
              level = static_cast<double>(random() % 256) / 255;
            chip.set(levels);
          }
          const std::size_t most = chip.most_under_way;
          for (double &level : levels)
            level = std::fmod(level + 0.5, 1.0);
          const Time set = chip.now;
          chip.set(levels);
          chip.run_to(set + 10s, [&] { return chip.has(levels); });
          const Time packet = std::min(update + 3, 64) * kByte;
          fail_unless(
              most <= static_cast<std::size_t>(update) + 3
                  && chip.now - set <= update * kByte + packet,
              "%d tactors, %zu bytes in the chip, new levels each %d ms: %zu bytes in flight, "
              "last levels after %.1f ms",
              tactors, memory, static_cast<int>(every / 1ms), most,
              std::chrono::duration<double, std::milli>(chip.now - set).count());
          ck_assert_int_eq(chip.model.trips, 0);
        }
}

/// All levels but one keep changing, more than the line carries. The remaining one is sent within
/// the first round.
CHECK_TEST(test_fairness)
{
  for (const std::size_t quiet : { 0u, 31u, 63u }) {
    const Layout layout = chair(64);
    Chip chip(layout);
    const int pin = chip.board.pins()[quiet];
    const Time begin = chip.now;
    const auto has_come = [&] {
      return chip.model.duty[pin] == 255;
    };
    for (int i = 0; i < 200 && !has_come(); i++) {
      std::vector<double> levels(64, (i + 1) / 255.0);
      levels[quiet] = 1.0;
      chip.set(levels);
      chip.run_to(chip.now + 1ms, has_come);
    }
    fail_unless(has_come() && chip.now <= begin + level_bytes(layout) * kByte);
  }
}

/// A ramp has as many steps as the line carries, and each arrives before the next begins. In 100 ms
/// these are five steps of 20 ms for nine tactors, and two of 59.85 ms for 64.
CHECK_TEST(test_ramp)
{
  for (const int tactors : { 9, 36, 64 })
    for (const Time length : { 100ms, 1000ms }) {
      const Layout layout = chair(tactors);
      const Time update = level_bytes(layout) * kByte;
      Chip chip(layout);
      std::vector<std::size_t> all(layout.pwm.size());
      std::iota(all.begin(), all.end(), std::size_t{ 0 });
      fail_unless(chip.board.line().of(all) == update);

      SoftStart start;
      start.set_length(length);
      const Time begin = chip.now;
      int steps = 0;
      std::vector<double> levels;
      for (std::optional<Time> next = begin; next; next = start.next_step(chip.now)) {
        chip.run_to(*next);
        fail_unless(chip.has(levels), "step %d has not arrived when the next begins", steps);
        start.vibrate(chip.now, update);
        levels.assign(layout.pwm.size(), start.ceiling(chip.now));
        chip.set(levels);
        steps++;
      }
      const Time step = std::max(update, Time(20ms));
      ck_assert_int_eq(steps, static_cast<int>((length + step - 1ns) / step));
      fail_unless(levels.front() == 1 && chip.now - begin == (steps - 1) * step);
      chip.run_to(chip.now + update);
      fail_unless(chip.has(levels));
      ck_assert_uint_le(chip.most_under_way, static_cast<std::size_t>(level_bytes(layout)) + 3);
    }
}

/// A film that changes a number of tactors with every map. A block lasts as many maps as the line
/// needs. Its levels have arrived when its frame is shown, the last of them just then.
CHECK_TEST(test_blocks)
{
  struct
  {
    int changing; ///< the last ones of 64 tactors, 6 bytes each
    double rate;  ///< Hz
    Time frame;
    int frames; ///< in a block
  } const cases[] = {
    { 64, 0, 40ms, 2 },  { 64, 0, 10ms, 6 }, { 64, 0, 60ms, 1 }, { 64, 5, 40ms, 5 },
    { 64, 25, 40ms, 2 }, { 8, 0, 10ms, 1 },  { 9, 0, 10ms, 1 },  { 10, 0, 10ms, 2 },
  };
  for (const auto &film : cases) {
    Chip chip(chair(64));
    PlannerSettings settings = unlimited({ .rate = film.rate,
                                           .transport_latency = chip.board.line().all(),
                                           .line = chip.board.line() });
    CommandPlanner planner(64, settings);
    CommandQueue queue(64);
    const Time origin = chip.now;
    const auto run_to = [&](Time until) {
      while (chip.now < origin + until) {
        const Time refresh = chip.now - origin + 100ms;
        const Time next = std::min({ until, refresh, queue.next_due().value_or(until) });
        chip.run_to(origin + next);
        queue.take_due(next);
        std::vector<double> levels;
        for (const double volts : queue.levels())
          levels.push_back(volts / 3.0);
        chip.set(levels);
      }
    };

    std::vector<float> levels(64, 1.0f);
    int last = 0;
    for (int frame = 0; frame < 60; frame++) {
      // Only falls: a rise would be due earlier by its rise time.
      for (std::size_t i = levels.size() - static_cast<std::size_t>(film.changing); i < 64; i++)
        levels[i] = static_cast<float>(1.0 - frame / 100.0);
      const Time shown = (frame == 0 ? 1s : 3s) + frame * film.frame; // after their rise
      const std::vector<Command> commands = planner.plan(shown, film.frame, levels);
      if (frame == 0) {
        queue.push(commands);
        run_to(shown);
        continue;
      }
      if (commands.empty())
        continue;
      ck_assert_int_eq(frame - last, last == 0 ? 1 : film.frames);
      last = frame;
      ck_assert_uint_eq(commands.size(), static_cast<std::size_t>(film.changing));
      const Time line = (film.changing == 64 ? level_bytes(chair(64)) : 6 * film.changing) * kByte;
      fail_unless(std::ranges::all_of(
          commands, [&](const Command &command) { return command.lead == line; }));
      queue.push(commands);
      run_to(shown);
      fail_unless(chip.has({ levels.begin(), levels.end() }),
                  "%d tactors change at %.0f Hz, %d ms a frame: frame %d has not arrived",
                  film.changing, film.rate, static_cast<int>(film.frame / 1ms), frame);
    }
    ck_assert_int_gt(last, 60 - 1 - film.frames);
    ck_assert_uint_le(chip.most_under_way, static_cast<std::size_t>(FirmataBoard::kPacket));
  }
}

/// A lead covers the levels that change, not all of them. A calibrated motor's latency contains the
/// line time of its own level.
CHECK_TEST(test_lead_has_what_changes)
{
  const LineTime line(std::vector<int>(64, 6), kByte);
  const auto leads = [](const LineTime &on, Time rest, std::optional<Time> latency, auto changing,
                        int most) {
    PlannerSettings settings
        = unlimited({ .rate = 0, .transport_latency = on.all() + rest, .line = on });
    settings.limits.max_active = most;
    CommandPlanner planner(64, settings, std::vector<MotorParameters>(64, { .latency = latency }));
    planner.plan(1s, 40ms, std::vector<float>(64, 1.0f));
    std::vector<float> levels(64, 1.0f);
    std::fill_n(levels.begin(), changing, 0.5f);
    std::vector<Time> leads;
    for (const Command &command : planner.plan(3s, 40ms, levels))
      leads.push_back(command.lead);
    return leads;
  };
  for (const int changing : { 1, 5, 64 }) {
    const auto count = static_cast<std::size_t>(changing);
    const Time update = changing * 6 * kByte;
    fail_unless(leads(line, 2ms, {}, changing, 0) == std::vector<Time>(count, update + 2ms));
    fail_unless(leads(line, 2ms, 20ms, changing, 0)
                == std::vector<Time>(count, update - 6 * kByte + 20ms));
  }
  // Four stop and four start. The leads of those that start contain their rise time, too.
  const std::vector<Time> bare = leads({}, 0ms, {}, 60, 4);
  const std::vector<Time> carried = leads(line, 2ms, {}, 60, 4);
  ck_assert_uint_eq(carried.size(), 8);
  for (std::size_t i = 0; i < carried.size(); i++)
    fail_unless(carried[i] - bare[i] == 8 * 6 * kByte + 2ms);
}

/// The driver releases the board when it is closed, which discards what its chip still holds. By
/// then all motors must be off, also if the board's answer is lost.
CHECK_TEST(test_closed_means_that_motors_stand)
{
  for (const int tactors : { 4, 9, 15, 64 })
    for (const bool seat : { false, true })
      for (const bool answers : { true, false }) {
        Chip chip(chair(tactors), 128, seat);
        chip.set(std::vector<double>(static_cast<std::size_t>(tactors), 1.0));
        chip.run_to(chip.now + 200ms);
        fail_if(chip.model.is_silent());
        chip.is_heard = answers;
        chip.board.close(chip.now);
        const Time begin = chip.now;
        chip.run_to(begin + 10s, [&] { return chip.board.state() == FirmataBoard::State::closed; });
        fail_unless(chip.model.is_silent(), "%d motors are on, answers %d", tactors, answers);
        fail_unless(chip.is_carried());
        ck_assert_int_eq(chip.model.resets, 2);
        // Zeros, then reset and question of two bytes, plus one byte's time for each packet to wait
        // for.
        const Time line = (level_bytes(chair(tactors)) + 2 + 10) * kByte;
        const Time patience = answers ? Time(0) : tactor::FirmataPatience{}.acknowledge;
        fail_unless(chip.now - begin <= line + patience,
                    "%d motors, seat %d, answers %d: closed after %d us", tactors, seat, answers,
                    static_cast<int>((chip.now - begin) / 1us));
      }
}

CHECK_MAIN(slow_line)
