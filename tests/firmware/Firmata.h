// SPDX-License-Identifier: LGPL-2.1-or-later
//
// A stand-in for the parts of the Arduino library Firmata that the seat sketch uses, for the Uno
// and the Mega, written from the protocol (firmata/protocol, version 2.5). Debian has no package of
// the library. Boards run the real one.
#pragma once

#include <Arduino.h>
#include <string.h>

#define ANALOG_MESSAGE 0xE0
#define START_SYSEX 0xF0
#define SET_PIN_MODE 0xF4
#define END_SYSEX 0xF7
#define REPORT_VERSION 0xF9
#define SYSTEM_RESET 0xFF

#define ANALOG_MAPPING_QUERY 0x69
#define ANALOG_MAPPING_RESPONSE 0x6A
#define CAPABILITY_QUERY 0x6B
#define CAPABILITY_RESPONSE 0x6C
#define PIN_STATE_QUERY 0x6D
#define PIN_STATE_RESPONSE 0x6E
#define EXTENDED_ANALOG 0x6F
#define REPORT_FIRMWARE 0x79

#define PIN_MODE_PWM 0x03

#define TOTAL_PINS NUM_DIGITAL_PINS
#define IS_PIN_PWM(p) digitalPinHasPWM(p)
#define PIN_TO_PWM(p) (p)

class FirmataClass
{
public:
  typedef void (*Message)(uint8_t, int);
  typedef void (*Reset)();
  typedef void (*Sysex)(uint8_t command, uint8_t count, uint8_t *data);

  void begin(Stream &stream)
  {
    stream_ = &stream;
    send_version();
    send_firmware();
  }

  void setFirmwareNameAndVersion(const char *name, byte major, byte minor)
  {
    name_ = name;
    major_ = major;
    minor_ = minor;
  }

  void attach(uint8_t message, Message callback)
  {
    (message == ANALOG_MESSAGE ? analog_ : pin_mode_) = callback;
  }

  void attach(uint8_t, Reset callback)
  {
    reset_ = callback;
  }

  void attach(uint8_t, Sysex callback)
  {
    sysex_ = callback;
  }

  int available()
  {
    return stream_->available();
  }

  void processInput()
  {
    const int value = stream_->read();
    if (value >= 0)
      parse(value);
  }

  void write(byte value)
  {
    stream_->write(value);
  }

  byte getPinMode(byte pin)
  {
    return modes_[pin];
  }

  void setPinMode(byte pin, byte mode)
  {
    modes_[pin] = mode;
  }

  int getPinState(byte pin)
  {
    return states_[pin];
  }

  void setPinState(byte pin, int state)
  {
    states_[pin] = state;
  }

private:
  void parse(byte value)
  {
    if (command_ == START_SYSEX && value != END_SYSEX) {
      if (count_ < sizeof data_)
        data_[count_++] = value;
    } else if (command_ == START_SYSEX) {
      command_ = 0;
      if (count_ > 0 && data_[0] == REPORT_FIRMWARE)
        send_firmware();
      else if (count_ > 0)
        sysex_(data_[0], count_ - 1, data_ + 1);
    } else if (value == SYSTEM_RESET) {
      command_ = 0;
      reset_();
    } else if (value == REPORT_VERSION) {
      command_ = 0;
      send_version();
    } else if (value & 0x80) {
      command_ = value;
      count_ = 0;
    } else if (command_ != 0) {
      data_[count_++] = value;
      if (count_ == 2)
        message();
    }
  }

  /// Handles a command with its two data bytes.
  void message()
  {
    if (command_ == SET_PIN_MODE)
      pin_mode_(data_[0], data_[1]);
    else if ((command_ & 0xF0) == ANALOG_MESSAGE)
      analog_(command_ & 0x0F, data_[0] | data_[1] << 7);
    command_ = 0;
  }

  void send_version()
  {
    write(REPORT_VERSION);
    write(2);
    write(5);
  }

  void send_firmware()
  {
    write(START_SYSEX);
    write(REPORT_FIRMWARE);
    write(major_);
    write(minor_);
    for (const char *c = name_; *c; c++) {
      write(*c & 0x7F);
      write(*c >> 7 & 0x7F);
    }
    write(END_SYSEX);
  }

  Stream *stream_ = nullptr;
  const char *name_ = "";
  byte major_ = 0;
  byte minor_ = 0;
  Message analog_ = nullptr;
  Message pin_mode_ = nullptr;
  Reset reset_ = nullptr;
  Sysex sysex_ = nullptr;
  byte command_ = 0; ///< that is being received, 0 if none
  byte count_ = 0;
  byte data_[64];
  byte modes_[TOTAL_PINS] = {};
  int states_[TOTAL_PINS] = {};
};

static FirmataClass Firmata;
