// SPDX-License-Identifier: LGPL-2.1-or-later
//
// The seat sketch on an emulated ATmega2560 and ATmega328P (simavr): its answers, timer settings,
// and how motors are turned off. Times are cycles of the emulated chip, independent of the host.
// Usage: firmware-seat MEGA.elf UNO.elf
extern "C" {
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
}

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

// gstcheck.h defines a macro `fail`, so it follows the standard library's headers.
#include "support/check_tests.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kHertz = 16'000'000;
constexpr std::uint64_t kMillisecond = kHertz / 1000;
constexpr std::uint64_t kBit = 35 * 8;     ///< the divider's nearest to 57600 baud
constexpr std::uint64_t kByte = 11 * kBit; ///< 8N1 and one bit more, as in simavr
constexpr std::uint64_t kSoon
    = 3 * kMillisecond; ///< a byte reaches the program 0.75 ms after it was sent

/// Registers of a pin in the chip's data memory (data sheets of the ATmega2560 and ATmega328P,
/// "Register Summary"; Arduino's pin maps).
struct Pin
{
  int number;
  std::uint16_t port;    ///< PORTx; DDRx is one below
  int bit;               ///< of the port
  std::uint16_t control; ///< TCCRnA; TCCRnB is one above
  int connected;         ///< bit COMnx1 in it: the timer drives the pin
  std::uint16_t compare; ///< OCRnx, its low byte
};

/// All PWM pins of the Mega except 13, the LED.
constexpr Pin kPins[] = {
  { 2, 0x2E, 4, 0x90, 5, 0x9A },     { 3, 0x2E, 5, 0x90, 3, 0x9C },
  { 4, 0x34, 5, 0x44, 5, 0x48 },     { 5, 0x2E, 3, 0x90, 7, 0x98 },
  { 6, 0x102, 3, 0xA0, 7, 0xA8 },    { 7, 0x102, 4, 0xA0, 5, 0xAA },
  { 8, 0x102, 5, 0xA0, 3, 0xAC },    { 9, 0x102, 6, 0xB0, 5, 0xB4 },
  { 10, 0x25, 4, 0xB0, 7, 0xB3 },    { 11, 0x25, 5, 0x80, 7, 0x88 },
  { 12, 0x25, 6, 0x80, 5, 0x8A },    { 44, 0x10B, 5, 0x120, 3, 0x12C },
  { 45, 0x10B, 4, 0x120, 5, 0x12A }, { 46, 0x10B, 3, 0x120, 7, 0x128 },
};
constexpr Pin kLight = { 13, 0x25, 7, 0x44, 7, 0x47 };
constexpr Pin kUnoPins[] = {
  { 3, 0x2B, 3, 0xB0, 5, 0xB4 }, { 5, 0x2B, 5, 0x44, 5, 0x48 },  { 6, 0x2B, 6, 0x44, 7, 0x47 },
  { 9, 0x25, 1, 0x80, 7, 0x88 }, { 10, 0x25, 2, 0x80, 5, 0x8A }, { 11, 0x25, 3, 0xB0, 7, 0xB3 },
};

struct Model
{
  const char *chip;
  std::span<const Pin> pins;
  std::string sketch{};
};
Model mega{ "atmega2560", kPins };
Model uno{ "atmega328p", kUnoPins };

constexpr std::uint8_t kKeepalive[] = { 0xF0, 0x01, 0xF7 };

/// An Arduino with the sketch and a serial line.
class Board
{
public:
  explicit Board(const Model &model = mega) : pins_(model.pins)
  {
    elf_firmware_t firmware{};
    ck_assert_int_eq(elf_read_firmware(model.sketch.c_str(), &firmware), 0);
    avr_ = avr_make_mcu_by_name(model.chip);
    fail_unless(avr_ != nullptr);
    avr_init(avr_);
    avr_->frequency = kHertz;
    avr_->log = LOG_OUTPUT; // log nothing
    avr_load_firmware(avr_, &firmware);
    std::uint32_t flags = 0; // do not echo, do not sleep
    avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    input_ = avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(
        avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
        [](avr_irq_t *, std::uint32_t value, void *board) {
          static_cast<Board *>(board)->answer_.push_back(static_cast<std::uint8_t>(value));
        },
        this);
  }

  ~Board()
  {
    avr_terminate(avr_);
  }

  Board(const Board &) = delete;
  Board &operator=(const Board &) = delete;

  std::uint64_t now() const
  {
    return avr_->cycle;
  }

  void step()
  {
    const int state = avr_run(avr_);
    if (state == cpu_Done || state == cpu_Crashed) // not an assertion, which costs a system call
      ck_abort_msg("the chip stopped in state %d", state);
  }

  void run_until(std::uint64_t cycle)
  {
    while (now() < cycle)
      step();
  }

  void run_for(std::uint64_t cycles)
  {
    run_until(now() + cycles);
  }

  /// Runs until `done`; fails if that takes longer than `most` cycles.
  void run_while_not(const std::function<bool()> &done, std::uint64_t most)
  {
    const std::uint64_t end = now() + most;
    while (!done()) {
      step();
      if (now() >= end)
        ck_abort_msg("nothing happened in %u ms", static_cast<unsigned>(most / kMillisecond));
    }
  }

  /// Sends bytes at line speed. Returns when the last one has arrived.
  void send(std::initializer_list<std::uint8_t> bytes)
  {
    send(bytes.begin(), bytes.end());
  }

  template <class Iterator> void send(Iterator begin, Iterator end)
  {
    for (; begin != end; ++begin) {
      run_for(kByte);
      avr_raise_irq(input_, *begin);
    }
  }

  /// The bytes that the board sends until it is silent for 5 ms.
  Bytes take_answer()
  {
    std::size_t before;
    do {
      before = answer_.size();
      run_for(5 * kMillisecond);
    } while (answer_.size() != before);
    return std::exchange(answer_, {});
  }

  Bytes ask(std::initializer_list<std::uint8_t> question)
  {
    send(question);
    return take_answer();
  }

  bool has_answered() const
  {
    return !answer_.empty();
  }

  /// 0 to 255. A floating pin is 0, because of its pull-down resistor.
  int level(const Pin &pin) const
  {
    if (!driven(pin))
      return 0;
    if (memory(pin.control) >> pin.connected & 1)
      return memory(pin.compare);
    return memory(pin.port) >> pin.bit & 1 ? 255 : 0;
  }

  bool driven(const Pin &pin) const
  {
    return memory(static_cast<std::uint16_t>(pin.port - 1)) >> pin.bit & 1;
  }

  bool all_off() const
  {
    return std::ranges::all_of(pins_, [this](const Pin &pin) { return level(pin) == 0; });
  }

  std::span<const Pin> pins() const
  {
    return pins_;
  }

  /// PWM frequency of a pin in Hz, from mode and prescaler (data sheets).
  double frequency(const Pin &pin) const
  {
    const int prescalers[] = { 0, 1, 8, 64, 256, 1024, 0, 0 };
    const int timer_2_prescalers[] = { 0, 1, 8, 32, 64, 128, 256, 1024 };
    constexpr int kTimer2 = 0xB0;
    const int select = memory(static_cast<std::uint16_t>(pin.control + 1)) & 7;
    const int prescaler = (pin.control == kTimer2 ? timer_2_prescalers : prescalers)[select];
    const int mode = memory(pin.control) & 3; // of 8 bits: 1 is phase-correct, 3 is fast
    ck_assert(prescaler > 0 && (mode == 1 || mode == 3));
    return static_cast<double>(kHertz) / prescaler / (mode == 1 ? 510 : 256);
  }

  /// Replaces the program's next instruction by an endless loop. Returns its place and old value.
  /// Interrupts go on.
  std::pair<std::uint8_t *, std::uint16_t> hang()
  {
    while (!avr_->sreg[S_I])
      step();
    std::uint8_t *word = avr_->flash + avr_->pc;
    const auto was = static_cast<std::uint16_t>(word[0] | word[1] << 8);
    word[0] = 0xFF; // RJMP -1
    word[1] = 0xCF;
    return { word, was };
  }

private:
  int memory(std::uint16_t address) const
  {
    return avr_->data[address];
  }

  std::span<const Pin> pins_;
  avr_t *avr_ = nullptr;
  avr_irq_t *input_ = nullptr;
  Bytes answer_;
};

/// "visuotactile-seat" 1.1, each character as two 7-bit bytes.
Bytes
firmware_reply()
{
  Bytes bytes{ 0xF0, 0x79, 1, 1 };
  for (const char c : std::string("visuotactile-seat"))
    bytes.insert(bytes.end(), { static_cast<std::uint8_t>(c), 0 });
  bytes.push_back(0xF7);
  return bytes;
}

/// After the banner, sets each motor to PWM mode and `level`.
void
start(Board &board, std::uint8_t level = 0)
{
  board.take_answer();
  for (const Pin &pin : board.pins())
    board.send({ 0xF4, static_cast<std::uint8_t>(pin.number), 3 });
  for (const Pin &pin : board.pins())
    board.send({ 0xF0, 0x6F, static_cast<std::uint8_t>(pin.number),
                 static_cast<std::uint8_t>(level & 0x7F), static_cast<std::uint8_t>(level >> 7),
                 0xF7 });
  board.run_for(kSoon);
}

} // namespace

/// Motors are off from power-on, and actively driven to zero by the first byte of the banner.
CHECK_TEST(test_boot)
{
  Board board;
  board.run_while_not(
      [&] {
        if (!board.all_off())
          ck_abort_msg("a motor moves");
        return board.has_answered();
      },
      1000 * kMillisecond);
  for (const Pin &pin : kPins)
    fail_unless(board.driven(pin), "pin %d floats", pin.number);
  ck_assert_int_eq(board.level(kLight), 0);
}

CHECK_TEST(test_answers)
{
  Board board;
  Bytes greeting{ 0xF9, 2, 5 };
  const Bytes firmware = firmware_reply();
  greeting.insert(greeting.end(), firmware.begin(), firmware.end());
  fail_unless(board.take_answer() == greeting);
  fail_unless(board.ask({ 0xF9 }) == (Bytes{ 0xF9, 2, 5 }));
  fail_unless(board.ask({ 0xF0, 0x79, 0xF7 }) == firmware);
  fail_unless(board.ask({ 0xF0, 0x01, 0xF7 }).empty());

  Bytes capabilities{ 0xF0, 0x6C };
  Bytes mapping{ 0xF0, 0x6A };
  for (int number = 0; number < 70; number++) {
    if (std::ranges::find(kPins, number, &Pin::number) != std::end(kPins))
      capabilities.insert(capabilities.end(), { 3, 8 });
    capabilities.push_back(0x7F);
    mapping.push_back(0x7F);
  }
  capabilities.push_back(0xF7);
  mapping.push_back(0xF7);
  fail_unless(board.ask({ 0xF0, 0x6B, 0xF7 }) == capabilities);
  fail_unless(board.ask({ 0xF0, 0x69, 0xF7 }) == mapping);

  fail_unless(board.ask({ 0xF0, 0x6D, 3, 0xF7 }) == (Bytes{ 0xF0, 0x6E, 3, 1, 0, 0xF7 }));
  board.send({ 0xF4, 3, 3, 0xE3, 0x40, 1 });
  fail_unless(board.ask({ 0xF0, 0x6D, 3, 0xF7 }) == (Bytes{ 0xF0, 0x6E, 3, 3, 0x40, 1, 0xF7 }));
  fail_unless(board.ask({ 0xF0, 0x6D, 70, 0xF7 }).empty());
  fail_unless(board.ask({ 0xF0, 0x6D, 0xF7 }).empty());
}

/// Each motor gets its own level, by both messages. No other pin changes.
CHECK_TEST(test_levels)
{
  Board board;
  start(board);
  fail_unless(board.all_off());
  for (const Pin &pin : kPins) {
    const auto number = static_cast<std::uint8_t>(pin.number);
    const int level = 7 * pin.number % 251 + 3;
    const auto low = static_cast<std::uint8_t>(level & 0x7F);
    const auto high = static_cast<std::uint8_t>(level >> 7);
    if (number < 16)
      board.send({ static_cast<std::uint8_t>(0xE0 | number), low, high });
    else
      board.send({ 0xF0, 0x6F, number, low, high, 0xF7 });
  }
  board.run_for(kSoon);
  for (const Pin &pin : kPins)
    ck_assert_int_eq(board.level(pin), 7 * pin.number % 251 + 3);

  board.send({ 0xE3, 0x2C, 2 }); // 300
  board.send({ 0xF0, 0x6F, 44, 0x7F, 0x7F, 0x7F, 0xF7 });
  board.send({ 0xE5, 0, 0 });
  board.send({ 0xF4, 13, 3, 0xED, 0x7F, 1 }); // the LED
  board.run_for(kSoon);
  ck_assert_int_eq(board.level(kPins[1]), 255);
  ck_assert_int_eq(board.level(kPins[11]), 255);
  ck_assert_int_eq(board.level(kPins[3]), 0);
  ck_assert_int_eq(board.level(kLight), 0);
  ck_assert_int_eq(board.level(kPins[0]), 17);

  board.send({ 0xFF });
  board.run_for(kSoon);
  fail_unless(board.all_off());
  board.send({ 0xE3, 0x40, 1 }); // no PWM pin any more
  board.run_for(kSoon);
  fail_unless(board.all_off());
}

/// PWM is always at 31.4 kHz, except on timer 0 (pin 4 of the Mega, 5 and 6 of the Uno), whose 976
/// Hz are the core's clock. Levels do not change.
CHECK_TEST(test_frequency)
{
  for (const Model &model : { mega, uno }) {
    Board board(model);
    const auto check = [&](int level) {
      for (const Pin &pin : board.pins()) {
        const double expected = pin.control == 0x44 ? 16e6 / 64 / 256 : 16e6 / 510;
        ck_assert_msg(board.frequency(pin) == expected, "%s, pin %d: %.0f Hz", model.chip,
                      pin.number, board.frequency(pin));
        ck_assert_int_eq(board.level(pin), level);
      }
    };
    board.take_answer();
    check(0);
    for (const int level : { 1, 100, 254, 255, 0, 42 }) {
      start(board, static_cast<std::uint8_t>(level));
      check(level);
    }
    board.send({ 0xFF });
    board.run_for(kSoon);
    check(0);
    start(board, 200);
    check(200);
  }
}

/// Motors run for 250 ms after the last byte. Later commands work again.
CHECK_TEST(test_silence)
{
  for (const Model &model : { mega, uno }) {
    Board board(model);
    start(board, 200);
    board.send(std::begin(kKeepalive), std::end(kKeepalive));
    const std::uint64_t heard = board.now();
    board.run_until(heard + 248 * kMillisecond);
    for (const Pin &pin : board.pins())
      ck_assert_int_eq(board.level(pin), 200);
    board.run_until(heard + 253 * kMillisecond);
    fail_unless(board.all_off());
    board.run_for(300 * kMillisecond);
    fail_unless(board.all_off());

    const Pin &three = *std::ranges::find(board.pins(), 3, &Pin::number);
    board.send({ 0xE3, 0x40, 1 });
    board.run_for(kSoon);
    for (const Pin &pin : board.pins())
      ck_assert_int_eq(board.level(pin), &pin == &three ? 192 : 0);
    board.run_for(253 * kMillisecond);
    fail_unless(board.all_off());
  }
}

/// Any byte resets the watchdog, including keepalives.
CHECK_TEST(test_keepalive)
{
  Board board;
  start(board, 100);
  for (int i = 0; i < 6; i++) {
    board.run_for(200 * kMillisecond);
    if (i % 2)
      board.send({ 0xF9 });
    else
      board.send(std::begin(kKeepalive), std::end(kKeepalive));
    for (const Pin &pin : kPins)
      ck_assert_int_eq(board.level(pin), 100);
  }
}

/// The program hangs while the host goes on. The chip's watchdog resets it within 0.6 s, and it
/// sends its banner.
CHECK_TEST(test_hung_program)
{
  Board board;
  start(board, 100);
  board.take_answer();
  const auto [word, was] = board.hang();
  const std::uint64_t end = board.now() + 600 * kMillisecond;
  while (!board.all_off() && board.now() < end)
    board.send(std::begin(kKeepalive), std::end(kKeepalive));
  fail_unless(board.all_off());
  word[0] = static_cast<std::uint8_t>(was & 0xFF);
  word[1] = static_cast<std::uint8_t>(was >> 8);
  const Bytes greeting = board.take_answer();
  fail_unless(greeting.size() > 3
              && Bytes(greeting.begin(), greeting.begin() + 3) == (Bytes{ 0xF9, 2, 5 }));
  // It resets once. (A real chip's watchdog stays on after a reset, simavr's does not, so this does
  // not test that the sketch stops it.)
  board.run_for(700 * kMillisecond);
  fail_if(board.has_answered());
  fail_unless(board.ask({ 0xF9 }) == (Bytes{ 0xF9, 2, 5 }));
}

/// The sketch fits an Uno: 32 KiB of flash without the boot loader, 2 KiB of RAM with a quarter for
/// the stack. The real library is larger than its stand-in, so only half of the flash is allowed.
CHECK_TEST(test_size)
{
  elf_firmware_t firmware{};
  ck_assert_int_eq(elf_read_firmware(uno.sketch.c_str(), &firmware), 0);
  ck_assert_int_lt(static_cast<int>(firmware.flashsize), (32 * 1024 - 512) / 2);
  ck_assert_int_lt(static_cast<int>(firmware.datasize + firmware.bsssize), 2048 * 3 / 4);
}

int
main(int argc, char **argv)
{
  if (argc < 3)
    return 2;
  mega.sketch = argv[1];
  uno.sketch = argv[2];
  gst_check_init(&argc, &argv);
  return check_tests::run("seat", __FILE__);
}
