#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a sound has below a frequency, and what it has above, with the phases as they were, by scipy.

Usage: split.py HZ SOUND.wav BELOW.wav ABOVE.wav"""

import sys

import numpy as np
from scipy.io import wavfile
from scipy.signal import butter, sosfiltfilt

hz, sound, *parts = sys.argv[1:]
rate, samples = wavfile.read(sound)
for kind, file in zip(("lowpass", "highpass"), parts):
    # Forward and backward: 6 dB less at the frequency, 96 dB less an octave beside it.
    sections = butter(8, float(hz), kind, fs=rate, output="sos")
    part = sosfiltfilt(sections, samples, axis=0)
    if samples.dtype == np.int16:
        part = np.clip(np.round(part), -32768, 32767)
    wavfile.write(file, rate, part.astype(samples.dtype))
