#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The effective voltage of a coin motor at a firmware's PWM frequency.

A motor is a resistance, an inductance and a back-EMF that is proportional to speed. It has a low-side transistor, and a diode and a
capacitor in parallel. While the transistor is on, the terminals have the supply voltage. When it turns off, the motor's current discharges
the capacitor, at most to the diode's drop below zero, and ends. Then the terminals have the back-EMF.

Prints the steady voltage that gives the same speed: the table of docs/measured/pwm.md. With --check, compares the simulation with
closed-form solutions, and the page with the simulation.

Usage: motor_pwm.py [--check PAGE]
"""
import math
import sys

SUPPLY = 3.0  # V
RESISTANCE = 25.0  # ohm: 120 mA starting
FRICTION = 0.015  # A, whatever the speed
DRAG = 0.065  # A per volt of the motor's own: 80 mA at 3 V
DIODE = 0.3  # V, 1N5819 at 100 mA
CAPACITOR = 47e-9  # F
LEVELS = (0.5, 0.75, 1.5, 2.25, 2.7)  # V, by volts = supply * value / 255
STOCK = 16e6 / 64 / 510  # Hz; phase-correct, prescaler 64
TIMER_0 = 16e6 / 64 / 256  # fast, prescaler 64
SEAT = 16e6 / 510  # phase-correct, no prescaler


def mean_current(duty, hertz, coil, own, capacitor=CAPACITOR):
    """Simulates until the state is periodic. coil: L/R in seconds, own: back-EMF in volts."""
    steps = max(1200, round(1 / hertz / 2e-7))
    dt = 1 / hertz / steps
    current = volts = 0.0
    for _ in range(max(3, math.ceil(8 * coil * hertz) + 8 if hertz > 1e4 else 3)):
        total = 0.0
        for step in range(steps):
            if step < duty * steps:
                volts = SUPPLY
            elif capacitor > 0:
                volts = max(volts - current / capacitor * dt, -DIODE)
            else:
                volts = -DIODE if current > 0 else own
            before = current
            current += (volts - RESISTANCE * current - own) / (coil * RESISTANCE) * dt
            if capacitor == 0 and step >= duty * steps and before >= 0 > current:
                current = 0.0  # the diode ends it
            total += current
    return total / steps


def mean_current_without_capacitor(duty, hertz, coil, own):
    """The closed-form solution."""
    on, off = duty / hertz, (1 - duty) / hertz
    to_on, to_off = (SUPPLY - own) / RESISTANCE, -(own + DIODE) / RESISTANCE
    a, b = math.exp(-on / coil), math.exp(-off / coil)
    top = (to_on * (1 - a) + a * to_off * (1 - b)) / (1 - a * b)
    bottom = to_off + (top - to_off) * b
    if bottom < 0:  # discontinuous
        bottom, top = 0.0, to_on * (1 - a)
        off = coil * math.log(1 - top / to_off)
    charge = to_on * on + (bottom - to_on) * coil * (1 - a)
    charge += to_off * off + (top - to_off) * coil * (1 - math.exp(-off / coil))
    return charge * hertz


def steady_volts(level, hertz, coil):
    """The steady voltage that gives the same speed as these pulses, or 0 if the motor does not turn."""
    slow, fast = 0.0, SUPPLY
    for _ in range(10):
        own = (slow + fast) / 2
        if mean_current(level / SUPPLY, hertz, coil, own) > FRICTION + DRAG * own:
            slow = own
        else:
            fast = own
    return slow + RESISTANCE * (FRICTION + DRAG * slow) if slow > 0 else 0.0


def row(level):
    """Rows of the page's table."""
    volts = ("{:.2f}, {:.2f} V".format(*(steady_volts(level, hertz, coil) for coil in (10e-6, 40e-6))) for hertz in (STOCK, TIMER_0, SEAT))
    return f"| {level:.2f} V | " + " | ".join(volts) + " |"


def check(page):
    for hertz in (STOCK, SEAT):
        for duty in (1 / 6, 0.5, 0.9):
            for own in (0.1, 1.0):
                exact = mean_current_without_capacitor(duty, hertz, 10e-6, own)
                assert abs(mean_current(duty, hertz, 10e-6, own, 0) - exact) < 5e-4, (hertz, duty, own)
    # At low frequencies, pulses are independent: duty * (supply - own) / resistance, with an error below 3 %.
    assert abs(mean_current_without_capacitor(0.5, 10, 10e-6, 1.0) - 0.04) < 1e-3
    for level in LEVELS:
        for coil in (10e-6, 40e-6):
            assert abs(steady_volts(level, SEAT, coil) - level) < 0.08, (level, coil)
    assert steady_volts(1.5, STOCK, 10e-6) - 1.5 > 0.2
    assert steady_volts(0.75, STOCK, 10e-6) - 0.75 > 0.1
    with open(page, encoding="utf-8") as file:
        lines = file.read().splitlines()
    for level in LEVELS:
        assert row(level) in lines, f"{page} does not have {row(level)}"


if sys.argv[1:2] == ["--check"]:
    check(sys.argv[2])
else:
    print("| by the formula | " + " | ".join(f"{hertz / 1000:.2f} kHz" for hertz in (STOCK, TIMER_0, SEAT)) + " |")
    for level in LEVELS:
        print(row(level))
