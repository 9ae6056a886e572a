#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Writes the sounds that sound_real judges: those of packages that nothing was learned or chosen from, and people's voices.

Usage: real_mixes.py CACHE FOLDER      FOLDER/index: group, file, name, seconds of the onsets, with tabs between"""

import pathlib
import sys

import numpy as np
from real_sounds import IMPACTS, RATE, Sound, bed_of, decoded, mixed, onset_of, sounds

MINUTES = 5
APART = (1.5, 3.5)  # s, from one effect to the next
VOICES = ("/usr/share/asterisk/sounds/en_US_f_Allison/conf-*.g722", "/usr/share/asterisk/sounds/es_MX_f_Allison/conf-*.g722", "/usr/share/asterisk/sounds/fr/conf-*.gsm",
          "/usr/share/asterisk/sounds/it_IT_f_Menardi/conf-*.wav", "/usr/share/pocketsphinx/test/data/librivox/*.wav")

cache, folder = map(pathlib.Path, sys.argv[1:3])
folder.mkdir(exist_ok=True)
of = sounds("measure", cache)
of["speech"] = []
for pattern in VOICES:
    for file in sorted(pathlib.Path("/").glob(pattern[1:]))[:12]:
        kept = cache / "voices" / (file.parent.name + file.name)
        kept.parent.mkdir(exist_ok=True)
        if not kept.exists():
            kept.write_bytes(file.read_bytes())
        samples = decoded(kept, cache)
        of["speech"].append(Sound(samples - samples.mean(), file.name))
effects = [sound for kind in IMPACTS for sound in of.get(kind, [])]
index = open(folder / "index", "w")
count = 0


def write(group, samples, truth=(), name=""):
    global count
    count += 1
    samples.astype("<f4").tofile(folder / f"{count}.f32")
    print(group, f"{count}.f32", name, *(f"{at:.4f}" for at in truth), sep="\t", file=index)


def normal(samples, peak_db=-3):
    return samples * 10 ** (peak_db / 20) / np.abs(samples).max()


for seed in range(MINUTES):
    rng = np.random.default_rng(9000 + seed)
    for group, kind, ratio in (("silence", "silence", 0), ("music +6 dB", "music", 6), ("music 0 dB", "music", 0), ("music −6 dB", "music", -6), ("speech 0 dB", "speech", 0)):
        samples, truth = mixed(bed_of(kind, of, 60, rng), effects, ratio, rng, APART, plain=True)
        write(group, normal(samples), [at for at, *_ in truth])
    for kind in ("music", "speech", "both"):
        write({"both": "narrator"}.get(kind, kind + " alone"), normal(bed_of(kind, of, 60, rng)))
quiet = np.zeros(int(0.8 * RATE), np.float32)
for kind in (*IMPACTS, "engine", "ambient"):
    for sound in of.get(kind, []):
        for less in (0, 6, 12, 18, 24, 30, 36, 42, 48) if kind in IMPACTS else (0,):
            samples = np.concatenate([quiet, normal(sound.samples, -3 - less)])
            write(f"{kind}, −{less} dB" if less else kind, np.concatenate([samples, quiet]), [0.8 + onset_of(sound.samples) / RATE], sound.name)
