// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Chairs that are large for their line, in virtual time: behind USB there is a chip that takes bytes at once and lets them out as the
// line goes. What it holds is a queue that nobody can overtake, so it shall hold next to nothing.
#include "tactor/firmata_board.h"

#include "firmata_model.h"

#include <cmath>
#include <deque>
#include <numeric>
#include <random>
#include <vector>

#include <gst/check/gstcheck.h>

using namespace std::chrono_literals;
using namespace tactor;

namespace {

constexpr Time kByte = Time(1s) * 10 * 35 * 8 / 16'000'000; // as an Arduino makes 57600 baud

/// Pins from 2 on. With 64 there are 14 whose level takes 3 bytes and 50 of 6: 342 bytes, 59.85 ms.
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

/// A board behind a chip that takes what it is given as soon as the rest fits into its memory.
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
      while (!model.replies.empty()) { // in no time: that way is another wire
        board.received(std::span(&model.replies.front(), 1));
        model.replies.pop_front();
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

  FirmataModel model;
  FirmataBoard board;
  Time now{ 0 };
  std::size_t most_under_way = 0; ///< bytes

private:
  std::size_t memory_;
  std::deque<std::uint8_t> under_way_;
  Time carried_{ 0 }; ///< when the first of them is
  bool is_taken_ = true;
};

} // namespace

/// All get a new level again and again, sooner than the line carries them. However much the chip takes, no more than one update and a
/// keepalive is under way, and the last levels are there one update after they were set, behind the packet that was on the line.
GST_START_TEST(test_nothing_queues)
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
          fail_unless(most <= static_cast<std::size_t>(update) + 3
                          && chip.now - set <= update * kByte + packet,
                      "%d tactors, %zu bytes in the chip, new levels each %d ms: %zu bytes are "
                      "under way, and "
                      "the last levels come after %.1f ms",
                      tactors, memory, static_cast<int>(every / 1ms), most,
                      std::chrono::duration<double, std::milli>(chip.now - set).count());
          ck_assert_int_eq(chip.model.trips, 0);
        }
}
GST_END_TEST;

/// All but one change all the time, more than the line carries. That one's turn comes in the first round.
GST_START_TEST(test_everyone_has_a_turn)
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
GST_END_TEST;

static Suite *
slow_line_suite(void)
{
  Suite *suite = suite_create("slow_line");
  TCase *tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_nothing_queues);
  tcase_add_test(tests, test_everyone_has_a_turn);
  return suite;
}

GST_CHECK_MAIN(slow_line)
