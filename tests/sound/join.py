#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Joins recordings to a WAV file of at most 60 s. What each has at 0 Hz is taken out, so that no step is made between two of them.

Usage: join.py RATE JOINED.wav RECORDING ...      names that end in .raw have 16-bit samples of that rate"""

import subprocess
import sys

import numpy as np
from scipy.io import wavfile

rate, joined, *names = sys.argv[1:]
parts = []
for name in names:
    raw = ["-f", "s16le", "-ar", rate] if name.endswith(".raw") else []
    decoded = subprocess.run(
        ["ffmpeg", "-v", "error", *raw, "-i", name, "-f", "s16le", "-ac", "1", "-ar", rate, "-"], check=True, stdout=subprocess.PIPE
    )
    samples = np.frombuffer(decoded.stdout, "<i2").astype(float)
    parts.append(samples - samples.mean())
    if sum(map(len, parts)) >= 60 * int(rate):
        break
samples = np.concatenate(parts)[: 60 * int(rate)]
wavfile.write(joined, int(rate), np.clip(np.round(samples), -32768, 32767).astype(np.int16))
