#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""An Arduino with StandardFirmata as a USB device on vhci_hcd (USB/IP over a socket pair, no network).

Usage: usb_board.py --transport=cdc-acm|ftdi|ch340 --port=N --log=FILE [--pins=4,5] [--silent]

The USB chip is modeled on Arduino's 16u2: bytes from USB wait for the UART, which takes 10 bits per byte at the host's baud rate.
SET_LINE_CODING resets the UART. Bytes that still wait are sent at the new rate, which the sketch at 57600 baud cannot decode. Each event is
a line of the log: seconds, event. "pwm PIN LEVEL" is the sketch's compare register. Wire format: Documentation/usb/usbip_protocol.rst of
Linux."""
import argparse
import os
import selectors
import socket
import struct
import sys
import time

SUBMIT, UNLINK, RET_SUBMIT, RET_UNLINK = 1, 2, 3, 4
ECONNRESET, EPIPE = 104, 32
BAUD = 57600  # the sketch's


def device(vendor, product, release, device_class, serial):
    return struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0200, device_class, 0, 0, 64, vendor, product, release, 1, 2, 3 if serial else 0, 1)


def endpoint(address, attributes, size, interval):
    return struct.pack("<BBBBHB", 7, 5, address, attributes, size, interval)


def interface(number, endpoints, *classes):
    return struct.pack("<BBBBBBBBB", 9, 4, number, 0, endpoints, *classes, 0)


def configuration(interfaces, rest):
    return struct.pack("<BBHBBBBB", 9, 2, 9 + len(rest), interfaces, 1, 0, 0x80, 50) + rest


CDC_ACM = configuration(2, interface(0, 1, 2, 2, 1) + bytes([5, 0x24, 0, 0x10, 1, 4, 0x24, 2, 6, 5, 0x24, 6, 0, 1, 5, 0x24, 1, 0, 1])
                        + endpoint(0x82, 3, 8, 255) + interface(1, 2, 10, 0, 0) + endpoint(4, 2, 64, 1) + endpoint(0x83, 2, 64, 1))
CH340 = configuration(1, interface(0, 3, 255, 1, 2) + endpoint(0x82, 2, 32, 0) + endpoint(2, 2, 32, 0) + endpoint(0x81, 3, 8, 1))
FTDI = configuration(1, interface(0, 2, 255, 255, 255) + endpoint(0x81, 2, 64, 0) + endpoint(2, 2, 64, 0))


class Sketch:
    """StandardFirmata 2.5, fed byte by byte."""

    def __init__(self, pins, log, silent):
        self.pins, self.log, self.silent = pins, log, silent
        self.level = dict.fromkeys(pins, 0)
        self.message = bytearray()

    def set(self, pin, level):
        if pin in self.level and self.level[pin] != level:
            self.level[pin] = level
            self.log(f"pwm {pin} {level}")

    def byte(self, byte):
        """Handles a byte and returns the answer."""
        if self.silent:
            return b""
        if byte >= 0x80 and byte != 0xF7:
            self.message = bytearray([byte])
        elif self.message:
            self.message.append(byte)
        message = self.message
        if not message:
            return b""
        first = message[0]
        if first == 0xFF:
            for pin in self.pins:
                self.set(pin, 0)
            self.log("reset")
        elif first == 0xF9:
            return self.done(bytes([0xF9, 2, 5]))
        elif 0xE0 <= first < 0xF0:
            if len(message) < 3:
                return b""
            self.set(first - 0xE0, message[1] | message[2] << 7)
        elif first == 0xF0:
            if byte != 0xF7:
                return b""
            return self.done(self.sysex(message[1:-1]))
        elif len(message) < 3:
            return b""
        return self.done(b"")

    def done(self, answer):
        self.message = bytearray()
        return answer

    def sysex(self, body):
        if body[:1] == b"\x79":
            name = "".join(c + "\0" for c in "StandardFirmata.ino").encode()
            return bytes([0xF0, 0x79, 2, 5]) + name + b"\xf7"
        if body[:1] == b"\x6b":
            each = [bytes([1, 1, 3, 8, 0x7F]) if pin in self.pins else bytes([1, 1, 0x7F]) for pin in range(max(self.pins) + 1)]
            return b"\xf0\x6c" + b"".join(each) + b"\xf7"
        if body[:1] == b"\x6f" and len(body) >= 3:
            self.set(body[1], body[2] | (body[3] << 7 if len(body) > 3 else 0))
        return b""


class Board:
    def __init__(self, options):
        self.ftdi = options.transport == "ftdi"
        made = {"cdc-acm": (0x2341, 0x0042, 0x0001, 2, CDC_ACM, 3, "Arduino (www.arduino.cc)", "Mega 2560"),
                "ftdi": (0x0403, 0x6001, 0x0600, 0, FTDI, 1, "FTDI", "FT232R USB UART"),
                "ch340": (0x1A86, 0x7523, 0x0263, 255, CH340, 2, "", "USB Serial")}
        vendor, product, release, device_class, self.configuration, self.input, maker, name = made[options.transport]
        self.file = open(options.log, "w", buffering=1)
        self.sketch = Sketch([int(pin) for pin in options.pins.split(",")], self.log, options.silent)
        self.strings = ["", maker, name, options.serial]
        self.descriptor = device(vendor, product, release, device_class, options.serial)
        self.baud = 9600
        self.line = []  # (when its stop bit ends, byte)
        self.free = 0.0  # when the line is
        self.reads, self.answer = [], b""
        self.host, kernel = socket.socketpair()
        with open("/sys/devices/platform/vhci_hcd.0/attach", "w") as attach:
            attach.write(f"{options.port} {kernel.fileno()} {options.port + 2} 2")
        kernel.close()
        self.log("plugged")

    def log(self, text):
        self.file.write(f"{time.monotonic():.6f} {text}\n")

    # ---- USB
    def control(self, setup, data):
        kind, request, value, index, length = struct.unpack("<BBHHH", setup)
        if kind == 0x80 and request == 6:
            what, number = value >> 8, value & 255
            if what == 1:
                return self.descriptor[:length]
            if what == 2:
                return self.configuration[:length]
            if what == 3 and number < len(self.strings):
                text = b"\x09\x04" if number == 0 else self.strings[number].encode("utf-16le")
                return (bytes([len(text) + 2, 3]) + text)[:length]
            return None
        if kind == 0x80 and request == 0:
            return b"\0\0"
        if kind == 0x21 and request == 0x20:
            self.set_baud(struct.unpack("<I", data[:4])[0])
        elif kind == 0x21 and request == 0x22:
            self.log(f"dtr {value & 1}")
        elif kind == 0x40 and request == 3:
            self.set_baud(48000000 // 16 // (value & 0x3FFF or 1))
        elif kind == 0x40 and request == 1 and value & 0x100:
            self.log(f"dtr {value & 1}")
        elif kind == 0x40 and request == 0 and value == 0:
            self.log("ftdi reset")
        elif kind == 0x40 and request == 0x9A and value == 0x1312:  # CH341: divisor and prescaler, as linux/drivers/usb/serial/ch341.c has them
            self.set_baud(48000000 // (1 << 12 - 3 * (index & 3) - (index >> 2 & 1)) // (256 - (index >> 8)))
        elif kind == 0x40 and request == 0xA4:
            self.log(f"dtr {(~value >> 5) & 1}")
        elif kind == 0xC0 and request == 0x5F:
            return b"\x31\x00"[:length]
        elif kind & 0x80:
            return b"\x01\x60"[:length]
        return b""

    def set_baud(self, baud):
        now = time.monotonic()
        self.carry(now)
        lost = len(self.line)
        if lost:
            self.log(f"garbled {lost}")
        self.line, self.free = [], now
        self.baud = baud
        self.log(f"baud {baud}")

    def out(self, data):
        now = time.monotonic()
        self.log("out " + data.hex(" "))
        for byte in data:
            self.free = max(self.free, now) + 10 / self.baud
            if abs(self.baud - BAUD) < BAUD * 0.03:
                self.line.append((self.free, byte))

    def carry(self, now):
        while self.line and self.line[0][0] <= now:
            self.answer += self.sketch.byte(self.line.pop(0)[1])

    def feed(self):
        while self.reads and self.answer:
            number, length = self.reads.pop(0)
            status = b"\x01\x60" if self.ftdi else b""
            size = min(length, 64) - len(status)
            self.reply(number, 0, status + self.answer[:size])
            self.answer = self.answer[size:]

    # ---- USB/IP
    def reply(self, number, status, data=b"", length=None):
        self.host.sendall(struct.pack(">IIIII", RET_SUBMIT, number, 0, 0, 0)
                          + struct.pack(">iiiii8x", status, len(data) if length is None else length, 0, 0, 0) + data)

    def read(self, size):
        data = b""
        while len(data) < size:
            piece = self.host.recv(size - len(data))
            if not piece:
                self.log("unplugged")
                sys.exit(0)
            data += piece
        return data

    def request(self):
        header = self.read(48)
        command, number, _, to_host, point = struct.unpack(">IIIII", header[:20])
        if command == UNLINK:
            victim = struct.unpack(">I", header[20:24])[0]
            pending = [read for read in self.reads if read[0] == victim]
            self.reads = [read for read in self.reads if read[0] != victim]
            self.host.sendall(struct.pack(">IIIIIi24x", RET_UNLINK, number, 0, 0, 0, -ECONNRESET if pending else 0))
            return
        length = struct.unpack(">i", header[24:28])[0]
        data = self.read(length) if not to_host and length > 0 else b""
        if point == 0:
            answer = self.control(header[40:48], data)
            if answer is None:
                self.reply(number, -EPIPE)
            else:
                self.reply(number, 0, answer if to_host else b"", None if to_host else length)
        elif to_host:
            # Reads of interrupt endpoints are never answered.
            self.reads.append((number, length)) if point == self.input else None
        else:
            self.out(data)
            self.reply(number, 0, b"", length)

    def run(self):
        selector = selectors.DefaultSelector()
        selector.register(self.host, selectors.EVENT_READ)
        while True:
            wait = max(0, self.line[0][0] - time.monotonic()) if self.line else None
            if selector.select(wait):
                self.request()
            self.carry(time.monotonic())
            self.feed()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--transport", choices=["cdc-acm", "ftdi", "ch340"], default="cdc-acm")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--log", required=True)
    parser.add_argument("--pins", default="2,3,4,5,6,7,8,9,10")
    parser.add_argument("--serial", default="7573")
    parser.add_argument("--silent", action="store_true", help="a bare adapter: nothing answers")
    Board(parser.parse_args()).run()
