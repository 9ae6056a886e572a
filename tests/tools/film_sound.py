# SPDX-License-Identifier: LGPL-2.1-or-later
"""Sounds of films and rooms."""

import math
import random
import struct
import wave

RATE = 16000


def write(path, rate, samples):
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(struct.pack(f"<{len(samples)}h", *(int(max(-1, min(1, sample)) * 32767) for sample in samples)))
    return path


def make_sound(path, seed, seconds):
    """Tones and noise, at random."""
    chance, samples, at = random.Random(seed), [0.0] * (RATE * seconds), 0.0
    while at < seconds:
        hertz, length, tone = chance.uniform(200, 3000), chance.uniform(0.05, 0.5), chance.uniform(0, 0.3)
        first = int(at * RATE)
        for i in range(first, min(len(samples), first + int(length * RATE))):
            time = (i - first) / RATE
            samples[i] += (tone * math.sin(2 * math.pi * hertz * time) + (0.3 - tone) * chance.uniform(-0.5, 0.5)) * (1 - time / length)
        at += chance.uniform(0.03, 0.3)
    return write(path, RATE, [0.6 * sample for sample in samples])


def make_room(path, decay, rate):
    """What a click is in a room: after `decay` s it has faded by 60 dB, and the direct sound is as loud as the reverberation."""
    chance = random.Random(1)
    rest = [chance.uniform(-1, 1) * 10 ** (-3 * i / (decay * rate)) if i > rate * 0.002 else 0 for i in range(int(decay * rate))]
    loud = math.sqrt(sum(sample * sample for sample in rest))
    return write(path, rate, [0.9] + [0.9 * sample / loud for sample in rest[1:]])
