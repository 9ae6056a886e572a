#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Learns the weights of lib/sound/onset_weights.h, chooses among what it learned, and writes that file.

Sounds are made by sound_features, and by espeak-ng and festival, in other voices that say other words than those of the
measurement; two voices are recordings of people. Other seeds and other voices than those choose how many scores there are, and how much each
of them has to exceed 0. The measurement has a third set. A moment is an impact if all of a few linear scores are above 0. They are learned together: the probability of an impact is the product
of their logistic functions, and the weights are those of greatest likelihood (L-BFGS) with a small penalty on their squares. An impact has some
moments about its begin; the most probable of them stands for it, chosen again after each fit.

Usage: tests/sound/train.py BUILD [--features=FOLDER]      BUILD: a build folder; FOLDER keeps the features, or has them. About 15 minutes.
Needs espeak-ng, ffmpeg, python3-scipy, festival, festvox-kdlpc8k, festvox-ru, festvox-suopuhe-mv and asterisk-core-sounds-{fr,it,ru}-g722."""

import argparse
import csv
import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.optimize import minimize

# More than 1: an impact that is missed is worse than a false one, and a voice that is felt worse than a note.
BLOWS = 3.0
VOICES = 3.0
PENALTY = 1e-5
FITS = 4
SCORES = (4, 6)
MARGINS = (0, 0.25, 0.5, 0.75, 1, 1.25, 1.5)
F1_LESS = 0.005
DEAD_S = 0.08  # OnsetDetector::kDeadHops

TEXTS = (
    "The old miller woke before dawn. Outside, wind was pushing hard against the door. Who goes there? he called, but only the pump creaked. "
    "Ten days later he packed his bag, kissed his daughter and walked down to the valley. Could they trust a stranger? Perhaps not. Still, the "
    "bread had to be bought.",
    "Doctor Baker put the big box on top of the cupboard. Don't touch it! she shouted. It took twenty people, two carts and a patient donkey to "
    "bring it up here. Please keep quiet, and count to a hundred. By tomorrow evening the package will be back in the capital, if the bridge holds.",
    "What do you want? Nothing. Then get out of my way. Pull! Push! Keep going, don't stop, both of you. The current was too strong. Behind the "
    "boat a dark body turned under the water. Give me your hand, cried the boy. Take it, quick, before the tide comes.",
)
SPEAKERS = (
    "en+m1 en+m3 en-us+m6 en-gb+m7 en+f2 en-us+f4 en-gb-scotland+m2 en-029+f3 en-gb-x-rp+m8 en-gb-x-gbcwmd+f5 en-us+croak en+whisper "
    "en-us+m5 en-gb+f1 en-us+klatt2 en+m8"
).split()
NARROW = ("en+m1", "en+f2", "en-us+f4", "en-gb-x-rp+m8")  # also at 8 kHz
LEARNED = {"espeak": SPEAKERS, "festival": ("ked_diphone", "msu_ru_nsh_clunits"), "people": ("fr_CA_f_June", "ru_RU_f_IvrvoiceRU"), "seed": 1}
CHOSEN = {"espeak": "en+Andy en-us+linda en-gb+Alex en+steph en-us+Mike en-gb-scotland+zac".split(), "festival": ("hy_fi_mv_diphone",),
          "people": ("it_IT_m_Carlo",), "seed": 1001}
RECORDINGS = pathlib.Path("/usr/share/asterisk/sounds")

root = pathlib.Path(__file__).resolve().parents[2]


def run(*command, **options):
    subprocess.run(command, check=True, **options)


def speech(voices, folder):
    """Files of what these voices say, those of people and some others also at 8 kHz."""
    files = []

    def narrow():
        files.append(files[-1].with_suffix(".narrow.wav"))
        run("ffmpeg", "-v", "error", "-i", files[-2], "-ar", "8000", files[-1])

    for i, speaker in enumerate(voices["espeak"]):
        files.append(folder / f"{speaker}.wav")
        run("espeak-ng", "-v", speaker, "-s", str(120 + i % 7 * 12), "-p", str(10 + i * 5 % 65), "-w", files[-1], TEXTS[i % len(TEXTS)])
        if speaker in NARROW:
            narrow()
    for speaker in voices["festival"]:
        files.append(folder / f"{speaker}.wav")
        run("text2wave", "-eval", f"(voice_{speaker})", "-o", files[-1], input=" ".join(TEXTS), text=True)
    for speaker in voices["people"]:
        spoken = sorted(f for kind in ("demo", "conf", "dir") for f in (RECORDINGS / speaker).glob(f"{kind}-*.g722"))
        files.append(folder / f"{speaker}.wav")
        run("ffmpeg", "-v", "error", "-f", "g722", "-i", "concat:" + "|".join(map(str, spoken)), "-t", "60", files[-1])
        narrow()
    return files


def make_features(build, voices, file):
    with tempfile.TemporaryDirectory() as folder, open(file, "w") as out:
        run(build / "tests/sound/sound_features", str(voices["seed"]), *speech(voices, pathlib.Path(folder)), stdout=out)


class Moments:
    """Those at which an impact may begin."""

    def __init__(self, file):
        with open(file) as lines:
            rows = list(csv.reader(lines))
        self.of_voices = np.array([row[0] == "voices" for row in rows])
        self.impact = np.array([int(row[1]) for row in rows])
        self.seconds = np.array([float(row[2]) for row in rows])
        self.features = np.array([row[3:] for row in rows], dtype=float)

    def count(self, of, weights, offsets):
        """Impacts that are found, impacts, and others that are taken for one, of those moments."""
        is_on = of & (self.features @ weights.T + offsets > 0).all(axis=1)
        false = self.seconds[is_on & (self.impact == 0)]
        apart = np.abs(np.diff(false)) > DEAD_S
        impacts = of & (self.impact > 0)
        return len(np.unique(self.impact[is_on & impacts])), len(np.unique(self.impact[impacts])), int(apart.sum() + (len(false) > 0))


def log_probability(weights, features):
    return -np.logaddexp(0, -features @ weights.T).sum(axis=1)


def most_probable(weights, features, impact):
    """One moment of each impact."""
    moments = np.flatnonzero(impact)
    moments = moments[np.lexsort((-log_probability(weights, features[moments]), impact[moments]))]
    return moments[np.unique(impact[moments], return_index=True)[1]]


def fit(weights, impacts, others, costs):
    def loss(flat):
        now = flat.reshape(weights.shape)
        of_blows = impacts @ now.T
        of_others = others @ now.T
        impact = np.exp(np.minimum(-np.logaddexp(0, -of_others).sum(axis=1), -1e-9))
        penalized = np.hstack([now[:, :-1], np.zeros((len(now), 1))])
        strength = PENALTY * len(others)
        value = BLOWS * np.logaddexp(0, -of_blows).sum() - (costs * np.log1p(-impact)).sum() + strength / 2 * (penalized**2).sum()
        slope = -BLOWS * np.exp(-np.logaddexp(0, of_blows)).T @ impacts
        slope += ((costs * impact / (1 - impact))[:, None] * np.exp(-np.logaddexp(0, of_others))).T @ others
        return value, (slope + strength * penalized).ravel()

    return minimize(loss, weights.ravel(), jac=True, method="L-BFGS-B", options={"maxiter": 300}).x.reshape(weights.shape)


def learn(scores, moments):
    features, impact = moments.features, moments.impact
    mean, spread = features.mean(axis=0), features.std(axis=0) + 1e-6
    scaled = np.hstack([(features - mean) / spread, np.ones((len(features), 1))])
    is_other = impact == 0
    costs = np.where(moments.of_voices[is_other], VOICES, 1.0)
    weights = np.random.default_rng(1).normal(0, 0.1, (scores, scaled.shape[1]))
    weights[:, -1] = 2
    for _ in range(FITS):
        weights = fit(weights, scaled[most_probable(weights, scaled, impact)], scaled[is_other], costs)
    plain = weights[:, :-1] / spread
    return plain, weights[:, -1] - plain @ mean


def choose(learned, judges):
    """Of those whose F1 in notes is within F1_LESS of the best, the weights that take the fewest of the voices for an impact."""
    found = []
    for scores in SCORES:
        weights, offsets = learn(scores, learned)
        for margin in MARGINS:
            right, impacts, false = judges.count(~judges.of_voices, weights, offsets - margin)
            f1 = 2 * right / (right + false + impacts)
            of_blows, impacts, voices = judges.count(judges.of_voices, weights, offsets - margin)
            print(f"{scores} scores above {margin}: F1 {f1:.4f} in notes; in voices {of_blows} of {impacts} impacts and {voices} others", flush=True)
            found.append((f1, voices, weights, offsets - margin))
    enough = max(f1 for f1, *_ in found) - F1_LESS
    f1, voices, weights, offsets = min((one for one in found if one[0] >= enough), key=lambda one: (one[1], -one[0]))
    print(f"chosen: {len(weights)} scores, F1 {f1:.4f}, {voices} others")
    return weights, offsets


def write(weights, offsets):
    file = root / "lib/sound/onset_weights.h"
    scores = ",\n".join("Score{ { " + ", ".join(f"{w:.4f}" for w in row) + f" }}, {offset:.4f} }}" for row, offset in zip(weights, offsets))
    file.write_text(f"""// SPDX-License-Identifier: LGPL-2.1-or-later
//
// Made by tests/sound/train.py; do not edit.
#pragma once

#include "sound/onset_features.h"

namespace sound {{

/// A linear score of features.
struct Score
{{
  Features weights;
  double offset;
}};

inline constexpr std::array kScores{{
{scores},
}};

}} // namespace sound
""")
    run("clang-format-14", "-i", file)


parser = argparse.ArgumentParser()
parser.add_argument("build", type=pathlib.Path)
parser.add_argument("--features", type=pathlib.Path)
options = parser.parse_args()
with tempfile.TemporaryDirectory() as folder:
    moments = []
    for name, voices in (("learned", LEARNED), ("chosen", CHOSEN)):
        file = (options.features or pathlib.Path(folder)) / f"{name}.csv"
        if not file.exists():
            make_features(options.build, voices, file)
        moments.append(Moments(file))
    write(*choose(*moments))
