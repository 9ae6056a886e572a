#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Joins recordings to a WAV file of at most 60 s. What each has at 0 Hz is taken out, so that no step is made between two of them.

Usage: join.py RATE JOINED.wav RECORDING ...      names that end in .raw have 16-bit samples of that rate"""

import subprocess
import sys
import tempfile

import numpy as np
from scipy.io import wavfile

rate, joined, *names = sys.argv[1:]
inputs, outputs, parts = [], [], []
with tempfile.TemporaryDirectory() as folder:
    for i, name in enumerate(names):
        raw = ["-f", "s16le", "-ar", rate] if name.endswith(".raw") else []
        inputs += [*raw, "-i", name]
        outputs += ["-map", f"{i}:a", "-f", "s16le", "-ac", "1", "-ar", rate, f"{folder}/{i}"]
    # One process for all: a start takes longer than a recording.
    subprocess.run(["ffmpeg", "-v", "error", *inputs, *outputs], check=True)
    for i in range(len(names)):
        samples = np.fromfile(f"{folder}/{i}", "<i2").astype(float)
        parts.append(samples - samples.mean())
samples = np.concatenate(parts)[: 60 * int(rate)]
wavfile.write(joined, int(rate), np.clip(np.round(samples), -32768, 32767).astype(np.int16))
