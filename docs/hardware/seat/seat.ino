// SPDX-License-Identifier: LGPL-2.1-or-later
//
// seat: firmware for a board that drives the tactors (vibration motors) of a chair.
//
// It speaks the part of Firmata 2.5 that `tactorsink driver=seat` needs, as StandardFirmata does, and adds what that has not: when the
// host says nothing for 250 ms, not a single byte, all motors are turned off. A host with nothing to say sends the keepalive F0 01 F7.
//
//   host sends                 board does
//   F4 pin 03                  pin becomes PWM, at zero
//   E0+pin lsb msb             PWM of pins 0…15; more than 255 is taken as 255
//   F0 6F pin lsb msb F7       the same, for any pin
//   F0 6B F7                   answers F0 6C (03 08 7F | 7F)* F7: each pin is 8-bit PWM or nothing
//   F0 69 F7                   answers F0 6A (7F)* F7: no pin is an analog input
//   F0 6D pin F7               answers F0 6E pin mode lsb [msb] F7
//   F0 79 F7, F9               answers its name and version, the protocol's version (by the Firmata library)
//   F0 01 F7                   nothing: being heard is all
//   FF                         all motors off, no pin is PWM any more
//
// Needs the Firmata library (2.5 or newer); see docs/hardware for how to put it on a board. 57600 baud.
#include <Firmata.h>

static const unsigned long kSilence = 250; // ms

static unsigned long heard; // ms, when the last byte came from the host

// The chip's own watchdog resets it if loop() is not reached for half a second, which is longer than anything here takes. In a reset
// all pins float, and the pull-down resistors keep the motors off.
#if defined(__AVR__) && defined(WDTCSR)
#include <avr/wdt.h>

// After such a reset the watchdog still runs, at its shortest time: stop it before anything else happens.
void watchdog_stop() __attribute__((naked, used, section(".init3")));
void
watchdog_stop()
{
  MCUSR = 0;
  wdt_disable();
}

static void
watchdog_start()
{
  wdt_enable(WDTO_500MS);
}

static void
watchdog_feed()
{
  wdt_reset();
}
#else
static void
watchdog_start()
{
}

static void
watchdog_feed()
{
}
#endif

// At the core's 490 Hz the current through a coin motor ends within each pulse, and what the motor makes of a level is not
// volts = supply * value / 255 (docs/hardware). Without prescalers the timers are 64 times as fast, 31.4 kHz, and it is. Not timer 0, which
// is the core's clock: pin 4 of a Mega and pins 5 and 6 of an Uno stay at 976 Hz.
#if defined(__AVR__) && defined(TCCR1B) && defined(CS10)
// CSn2...0 are the lowest bits in every timer, and 1 is no prescaler.
static void
speed_up(volatile uint8_t &control)
{
  control = (control & ~0x07) | 0x01;
}

static void
speed_up_pwm()
{
  speed_up(TCCR1B);
#ifdef TCCR2B
  speed_up(TCCR2B);
#endif
#ifdef TCCR3B
  speed_up(TCCR3B);
#endif
#ifdef TCCR4B
  speed_up(TCCR4B);
#endif
#ifdef TCCR5B
  speed_up(TCCR5B);
#endif
}
#else
static void
speed_up_pwm()
{
}
#endif

// Not the pin of the board's light, which the boot loader blinks.
static bool
can_drive_motor(byte pin)
{
#ifdef LED_BUILTIN
  if (pin == LED_BUILTIN)
    return false;
#endif
  return pin < TOTAL_PINS && IS_PIN_PWM(pin);
}

static void
set_level(byte pin, int level)
{
  analogWrite(PIN_TO_PWM(pin), level);
  Firmata.setPinState(pin, level);
}

// Every pin that can drive a motor low, whatever its mode; the modes stay.
static void
motors_off()
{
  for (byte pin = 0; pin < TOTAL_PINS; pin++) {
    if (!can_drive_motor(pin))
      continue;
    pinMode(PIN_TO_PWM(pin), OUTPUT);
    set_level(pin, 0);
  }
}

static void
on_reset()
{
  motors_off();
  for (byte pin = 0; pin < TOTAL_PINS; pin++)
    Firmata.setPinMode(pin, OUTPUT);
}

static void
on_pin_mode(byte pin, int mode)
{
  if (!can_drive_motor(pin))
    return;
  set_level(pin, 0);
  Firmata.setPinMode(pin, mode == PIN_MODE_PWM ? PIN_MODE_PWM : OUTPUT);
}

static void
on_analog(byte pin, int value)
{
  if (can_drive_motor(pin) && Firmata.getPinMode(pin) == PIN_MODE_PWM)
    set_level(pin, constrain(value, 0, 255));
}

static void
send_capabilities()
{
  Firmata.write(START_SYSEX);
  Firmata.write(CAPABILITY_RESPONSE);
  for (byte pin = 0; pin < TOTAL_PINS; pin++) {
    if (can_drive_motor(pin)) {
      Firmata.write(PIN_MODE_PWM);
      Firmata.write(8); // bits
    }
    Firmata.write(0x7F);
  }
  Firmata.write(END_SYSEX);
}

static void
send_analog_mapping()
{
  Firmata.write(START_SYSEX);
  Firmata.write(ANALOG_MAPPING_RESPONSE);
  for (byte pin = 0; pin < TOTAL_PINS; pin++)
    Firmata.write(0x7F);
  Firmata.write(END_SYSEX);
}

static void
send_pin_state(byte pin)
{
  if (pin >= TOTAL_PINS)
    return;
  const int state = Firmata.getPinState(pin);
  Firmata.write(START_SYSEX);
  Firmata.write(PIN_STATE_RESPONSE);
  Firmata.write(pin);
  Firmata.write(Firmata.getPinMode(pin));
  Firmata.write(state & 0x7F);
  if (state > 0x7F)
    Firmata.write(state >> 7 & 0x7F);
  Firmata.write(END_SYSEX);
}

static void
on_sysex(byte command, byte count, byte *data)
{
  switch (command) {
  case CAPABILITY_QUERY:
    send_capabilities();
    break;
  case ANALOG_MAPPING_QUERY:
    send_analog_mapping();
    break;
  case PIN_STATE_QUERY:
    if (count >= 1)
      send_pin_state(data[0]);
    break;
  case EXTENDED_ANALOG:
    if (count == 2)
      on_analog(data[0], data[1]);
    else if (count == 3)
      on_analog(data[0], data[1] | data[2] << 7);
    else if (count > 3)
      on_analog(data[0], 255); // 14 bits would have done
    break;
  }
}

void
setup()
{
  on_reset(); // the motors first
  speed_up_pwm();

  Firmata.setFirmwareNameAndVersion("visuotactile-seat", 1, 1);
  Firmata.attach(SET_PIN_MODE, on_pin_mode);
  Firmata.attach(ANALOG_MESSAGE, on_analog);
  Firmata.attach(START_SYSEX, on_sysex);
  Firmata.attach(SYSTEM_RESET, on_reset);
  Serial.begin(57600);
  Firmata.begin(Serial); // not begin(57600): that would blink for two seconds
  heard = millis();
  watchdog_start();
}

void
loop()
{
  watchdog_feed();
  if (Firmata.available()) {
    Firmata.processInput();
    heard = millis();
  } else if (millis() - heard >= kSilence) {
    motors_off();
    heard = millis();
  }
}
