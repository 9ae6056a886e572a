#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Learns lib/sound/onset_weights.h and rumble_weights.h, from real sounds (real_sounds.py) and some synthetic ones, and writes them.

A mix has a bed (music, speech, both, ambience, noise or silence) and effects at −8 to +16 dB, in rooms, through filters, faster and
slower, limited, coded, at −30 to −1 dB of full scale. Each effect is a bag of moments about its onset; the most probable stands for it,
chosen again in each epoch. One hidden layer. Of several starts the best one is taken, and the threshold is where the music of the set
for choosing has PER_MINUTE impacts.

Usage: OMP_NUM_THREADS=1 tests/sound/train.py BUILD CACHE [CORES] [tune]      BUILD: a build folder with tests/sound/sound_features;
CACHE: keeps packages and sounds; tune: goes on from the weights that are there, instead of anew. About half an hour of a core. Needs
ffmpeg, python3-scipy and apt-get."""

import multiprocessing
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
from real_sounds import RATE, bed_of, coded, limited, mixed, sounds
from scipy.optimize import minimize

HIDDEN = 40
EPOCHS = 12
TUNE_EPOCHS = 6
SEEDS = (1, 2, 3)
BATCH, POSITIVES, HARD = 1792, 256, 512
OF_IMPACTS, OF_SPEECH = 2.0, 5.0  # weights; others' are 1
PER_MINUTE = 1.15  # other music gives about three times as many
# As OnsetDetector: the score of three moments in a row, which is within ± MOST.
IN_ROW, MOST = 3, 8.0
FLUX = 67  # the feature
RUMBLE_IN_MUSIC = 0.025
DEAD_S = 0.15  # OnsetDetector::kDeadHops
FILM_S = 60
LEARN = {"music": 60, "speech": 8, "both": 10, "dialog": 24, "silence": 16, "noise": 5, "ambient": 8}
ALONE = {"music": 80, "speech": 12, "both": 10, "dialog": 32, "ambient": 8}
CHOOSE = {"music": 12, "speech": 3, "dialog": 4, "silence": 3}
CHOOSE_ALONE = {"music": 28, "speech": 5, "dialog": 14, "both": 3}
CHOOSE_RATIOS = (6, 0, -6)
TIMES = {"explosion": 3, "impact": 1, "gun": 2, "footstep": 1}

root = pathlib.Path(__file__).resolve().parents[2]
build, cache = map(pathlib.Path, sys.argv[1:3])
program = build / "tests/sound/sound_features"
loaded = {}  # of each set, for all processes


def finish(samples, rng, folder):
    if rng.random() < 0.5:
        samples = limited(samples, rng)
    if rng.random() < 0.08:
        codec, rate = [("libvorbis", "40k"), ("aac", "48k"), ("libopus", "32k")][rng.integers(3)]
        samples = coded(samples, codec, rate, folder)
    return samples * 10 ** (rng.uniform(-30, -1) / 20) / (np.abs(samples).max() + 1e-9)


def film(name, kind, ratio, seed, folder):
    """Samples, onsets and name. `ratio`: None for no effects, True for any."""
    of = loaded[name]
    rng = np.random.default_rng(seed)
    bed = bed_of(kind, of, FILM_S, rng)
    if ratio is None:
        return finish(bed, rng, folder), [], kind + " alone"
    effects = [s for k, times in TIMES.items() for s in of.get(k, []) * times]
    samples, truth = mixed(bed, effects, (lambda: rng.uniform(-8, 16)) if ratio is True else ratio, rng)
    return finish(samples, rng, folder), [at for at, *_ in truth], kind if ratio is True else f"{kind} {ratio:+}"


def synthetic(what, seed, folder):
    """Of tests/sound's synthetic sounds."""
    made = subprocess.run([program, "make", str(seed), what, folder / "made.f32"], check=True, stdout=subprocess.PIPE, text=True)
    return np.fromfile(folder / "made.f32", "<f4"), [float(line) for line in made.stdout.split()], "synthetic " + what


def features(samples, of, folder):
    """Rows: the hop's number, then its features."""
    (folder / "film.f32").write_bytes(samples.astype("<f4").tobytes())
    out = subprocess.run([program, of, folder / "film.f32"], check=True, stdout=subprocess.PIPE)
    width = int(subprocess.run([program, of], stdout=subprocess.PIPE, check=True).stdout)
    return np.frombuffer(out.stdout, "<f4").reshape(-1, width + 1)


def moments_of(job):
    make, *arguments = job
    with tempfile.TemporaryDirectory() as folder:
        samples, truth, name = make(*arguments, pathlib.Path(folder))
        return features(samples, "impacts", pathlib.Path(folder)), len(samples) / RATE, truth, name


class Moments:
    """Those at which an impact may begin."""

    def __init__(self, jobs, pool):
        rows, seconds, bag, film_of, kinds, offset, bags = [], [], [], [], [], 0, 0
        for read, length, truth, kind in pool.imap(moments_of, jobs):
            at = read[:, 0] * 0.005
            mine = np.zeros(len(at), np.int32)
            for onset in truth:
                bags += 1
                mine[(at > onset - 0.06) & (at < onset + 0.16) & (mine == 0)] = -1
                mine[(at > onset - 0.011) & (at < onset + 0.041)] = bags
            rows.append(read[:, 1:])
            seconds.append(at + offset)
            bag.append(mine)
            film_of.append(np.full(len(at), len(kinds)))
            kinds.append((kind, length, offset, truth))
            offset += length + 1
        self.rows, self.seconds, self.bag, self.film = map(np.concatenate, (rows, seconds, bag, film_of))
        self.kinds = kinds
        print(f"{len(self.rows)} moments, {len(np.unique(self.bag[self.bag > 0]))} of {bags} impacts", flush=True)


def forward(net, x):
    hidden = np.maximum(x @ net["w"] + net["b"], 0)
    return hidden, hidden @ net["v"] + net["c"]


def scaled(rows, net):
    return np.clip((rows - net["mean"]) / net["spread"], -4, 4).astype(np.float32)


def scores(net, x):
    return np.concatenate([forward(net, x[i : i + 65536])[1] for i in range(0, len(x), 65536)])


def judged_score(moments, net):
    """Of each moment the mean of the last three."""
    score = np.clip(scores(net, scaled(moments.rows, net)), -MOST, MOST)
    total = score.copy()
    for back in range(1, IN_ROW):
        is_next = np.abs(moments.seconds[back:] - moments.seconds[:-back] - 0.005 * back) < 0.001
        total[:back] -= MOST
        total[back:] += np.where(is_next, score[:-back], -MOST)
    return total / IN_ROW


def best_of_bags(moments, score):
    ours = np.flatnonzero(moments.bag > 0)
    ours = ours[np.lexsort((-score[ours], moments.bag[ours]))]
    return ours[np.unique(moments.bag[ours], return_index=True)[1]]


def present():
    """The network in the tree."""
    text = (root / "lib/sound/onset_weights.h").read_text()
    found = {name: np.array([float(value.strip(" F\n")) for value in values.split(",")], np.float32) for name, values in re.findall(r"kOnset(\w+)\{(.*?)\};", text, re.S)}
    units = len(found["Out"])
    return {"mean": found["Mean"], "spread": 1 / found["Scale"], "w": found["Hidden"].reshape(units, -1).T.copy(), "b": found["HiddenOffset"], "v": found["Out"],
            "c": np.float32(re.search(r"kOnsetOffset = ([-.\d]+)F", text)[1])}


def learn(moments, seed, start=None, hidden=HIDDEN, of_speech=OF_SPEECH, of_impacts=OF_IMPACTS):
    epochs, first_rate = (TUNE_EPOCHS, 0.001) if start else (EPOCHS, 0.003)
    rng = np.random.default_rng(seed)
    width = moments.rows.shape[1]
    net = start or {"w": rng.normal(0, width**-0.5, (width, hidden)), "b": np.zeros(hidden), "v": rng.normal(0, hidden**-0.5, hidden), "c": np.array(-1.0)}
    net = {k: v.astype(np.float32) for k, v in net.items()}
    adam = {k: [np.zeros_like(net[k]), np.zeros_like(net[k])] for k in "wbvc"}
    if not start:
        net |= {"mean": moments.rows.mean(axis=0), "spread": moments.rows.std(axis=0) + 1e-3}
    x = scaled(moments.rows, net)
    others = np.flatnonzero(moments.bag == 0)
    speech = np.array([kind.startswith(("speech", "both", "dialog")) for kind, *_ in moments.kinds])[moments.film]
    step = 0
    score = scores(net, x) if start else x[:, FLUX]
    for epoch in range(epochs):
        impacts = best_of_bags(moments, score)
        # Those that are taken for impacts count more.
        hard = others[score[others] > np.quantile(score[others], 0.93)] if epoch or start else others
        order = rng.permutation(others)
        batches = max(1, len(order) // BATCH)
        for i in range(batches):
            rate = first_rate * (1 - (epoch + i / batches) / epochs) + 5e-5
            pick = np.concatenate([rng.choice(impacts, POSITIVES), order[i * BATCH :][:BATCH], rng.choice(hard, HARD)])
            y = np.zeros(len(pick), np.float32)
            y[:POSITIVES] = 1
            weight = np.where(y > 0, of_impacts, np.where(speech[pick], of_speech, 1.0)).astype(np.float32)
            xs = x[pick]
            inner, out = forward(net, xs)
            error = weight * (1 / (1 + np.exp(-out)) - y) / len(pick)
            back = np.outer(error, net["v"]) * (inner > 0)
            slopes = {"w": xs.T @ back + 3e-5 * net["w"], "b": back.sum(0), "v": inner.T @ error + 3e-5 * net["v"], "c": error.sum()}
            step += 1
            for k, slope in slopes.items():
                m, s = adam[k]
                m += 0.1 * (slope - m)
                s += 0.001 * (slope**2 - s)
                net[k] = net[k] - (rate * m / (1 - 0.9**step) / (np.sqrt(s / (1 - 0.999**step)) + 1e-8)).astype(np.float32)
        score = scores(net, x)
    return net


def found(seconds, score, least):
    at, last = [], -1.0
    for t in seconds[score > least]:
        if t - last >= DEAD_S:
            at.append(t)
            last = t
    return np.array(at)


def rate_of(moments, score, least, kind):
    """Impacts a minute that are found in films of this kind."""
    films = [i for i, (name, *_) in enumerate(moments.kinds) if name == kind]
    minutes = sum(moments.kinds[i][1] for i in films) / 60
    return sum(len(found(moments.seconds[moments.film == i], score[moments.film == i], least)) for i in films) / minutes


def judged(moments, score, least):
    """F1 of each kind of film with impacts, impacts a minute of each without."""
    result = {}
    for i, (kind, seconds, offset, truth) in enumerate(moments.kinds):
        at = found(moments.seconds[moments.film == i], score[moments.film == i], least) - offset
        free, right = list(at), 0
        for onset in truth:
            near = [t for t in free if abs(t - onset) <= 0.05]
            if near:
                free.remove(near[0])
                right += 1
        row = result.setdefault(kind, [0, 0, 0, 0])
        for j, value in enumerate((right, len(at), len(truth), seconds)):
            row[j] += value
    return {kind: 2 * right / (count + truths) if truths else count * 60 / seconds for kind, (right, count, truths, seconds) in result.items()}


def threshold(moments, score, most, kind="music alone"):
    low, high = -8.0, 15.0
    for _ in range(10):
        middle = (low + high) / 2
        low, high = (low, middle) if rate_of(moments, score, middle, kind) <= most else (middle, high)
    return high


def array(name, values):
    numbers = (f"{value:.4g}" for value in np.ravel(values))
    return f"inline constexpr std::array<float, {np.size(values)}> {name}{{ " + ", ".join(n + ("F" if set(n) & set(".e") else ".F") for n in numbers) + " };\n"


def write(name, comment, body):
    file = root / "lib/sound" / name
    file.write_text(f"// SPDX-License-Identifier: LGPL-2.1-or-later\n//\n// Made by tests/sound/train.py; do not edit.\n#pragma once\n\n#include <array>\n\n"
                    f"/// {comment}\nnamespace sound {{\n\n{body}\n}} // namespace sound\n")
    subprocess.run(["clang-format-14", "-i", file], check=True)


def network(prefix, net, least):
    return (array(prefix + "Mean", net["mean"]) + array(prefix + "Scale", 1 / net["spread"]) + array(prefix + "Hidden", net["w"].T)
            + array(prefix + "HiddenOffset", net["b"]) + array(prefix + "Out", net["v"]) + f"inline constexpr float {prefix}Offset = {net['c']:.4f}F;\n"
            + f"/// The mean score of an impact is above.\ninline constexpr float {prefix}Least = {least:.4f}F;\n")


def jobs_of(name, plan, alone, ratios, seed):
    jobs = [(film, name, kind, ratios[i % len(ratios)]) for kind, count in plan.items() for i in range(count)]
    jobs += [(film, name, kind, None) for kind, count in alone.items() for _ in range(count)]
    return [(*job, (seed, i)) for i, job in enumerate(jobs)]


def read(pool):
    made = ("impacts", "impacts", "explosions", "impacts+0", "impacts+6", "music", "music")
    learned = Moments(jobs_of("learn", LEARN, ALONE, (True,), 1) + [(synthetic, what, 1 + i) for i, what in enumerate(made)], pool)
    return learned, Moments(jobs_of("choose", CHOOSE, CHOOSE_ALONE, CHOOSE_RATIOS, 2), pool)


def worth(moments, net):
    """The threshold, and the mean F1 there."""
    score = judged_score(moments, net)
    least = threshold(moments, score, PER_MINUTE)
    result = judged(moments, score, least)
    print(f"above {least:.2f}:", ", ".join(f"{kind} {value:.2f}" for kind, value in result.items()), flush=True)
    return np.mean([value for kind, value in result.items() if "alone" not in kind]), least


def impacts(moments, judges, start):
    nets = [learn(moments, seed, start) for seed in ((1,) if start else SEEDS)]
    (_, least), net = max(((worth(judges, net), net) for net in nets), key=lambda pair: pair[0][0])
    write("onset_weights.h", "One hidden layer of what OnsetFeatures knows.", network("kOnset", net, least))


def rumble_films(of, rng, minutes):
    """(samples, whether it is rumble)"""
    deep = of["engine"] + of["explosion"]
    for i in range(minutes):
        bed = bed_of(("silence", "music", "speech")[i % 3], of, FILM_S, rng)
        samples, truth = mixed(bed, deep, lambda: rng.uniform(0, 12), rng, (2.5, 4))
        hops = np.zeros(len(samples) // 80, bool)
        for at, *_ in truth:
            hops[int(at * 200) : int(at * 200 + 300)] = True
        yield finish(samples, rng, cache), hops, "rumble over " + ("silence", "music", "speech")[i % 3]
    for kind in ("music", "speech", "both"):
        for i in range(minutes // 2):
            yield finish(bed_of(kind, of, FILM_S, rng), rng, cache), np.zeros(FILM_S * 200, bool), kind + " alone"


def rumble(learn_from, choose_from):
    def read(of, seed, minutes):
        rng = np.random.default_rng(seed)
        x, y, kinds, hops = [], [], [], {}
        for samples, is_deep, kind in rumble_films(of, np.random.default_rng(seed), minutes):
            rows = features(samples * 10 ** (rng.uniform(6, 20) / 20), "rumble", cache)[:, 1:]
            is_deep = is_deep[: len(rows)]
            keep = (rows[:, 0] > -36) & (is_deep | ("alone" in kind))
            hops[kind] = hops.get(kind, 0) + (is_deep.sum() if "over" in kind else len(rows))
            x.append(rows[keep][:, 1:])
            y.append(is_deep[keep])
            kinds.append(np.full(keep.sum(), kind))
        return np.concatenate(x), np.concatenate(y), np.concatenate(kinds), hops

    x, y, kinds, hops = read(learn_from, 3, 9)
    mean, spread = x.mean(axis=0), x.std(axis=0) + 1e-3
    xs = np.hstack([np.clip((x - mean) / spread, -3, 3), np.ones((len(x), 1))])
    weight = np.where(y, 1 / y.sum(), 1 / (~y).sum())

    def loss(w):
        out = xs @ w
        return (weight * (np.logaddexp(0, out) - y * out)).sum() + 1e-4 * (w**2).sum(), xs.T @ (weight * (1 / (1 + np.exp(-out)) - y)) + 2e-4 * w

    w = minimize(loss, np.zeros(9), jac=True, method="L-BFGS-B").x
    print("rumble's weights:", dict(zip("middle high bass crest voicing uneven varying seconds offset".split(), w.round(2))))
    x, y, kinds, hops = read(choose_from, 4, 6)
    score = np.hstack([np.clip((x - mean) / spread, -3, 3), np.ones((len(x), 1))]) @ w
    least = np.quantile(np.concatenate([score[kinds == "music alone"], np.full(hops["music alone"] - (kinds == "music alone").sum(), -99)]), 1 - RUMBLE_IN_MUSIC)
    for kind, count in hops.items():
        print(f"  {kind}: {100 * (score[kinds == kind] > least).sum() / count:.1f} % of the time, deep {100 * (kinds == kind).sum() / count:.0f} %")
    write("rumble_weights.h", "The mean, scale and weight of each of RumbleFeatures after the first.",
          array("kRumbleMean", mean) + array("kRumbleScale", 1 / spread) + array("kRumbleWeights", w[:-1]) + f"inline constexpr float kRumbleOffset = {w[-1] - least:.4f}F;\n")


if __name__ == "__main__":
    loaded.update({name: sounds(name, cache) for name in ("learn", "choose")})
    tune = "tune" in sys.argv
    with multiprocessing.Pool(int(sys.argv[3]) if len(sys.argv) > 3 + tune else 1) as pool:
        impacts(*read(pool), present() if tune else None)
    if not tune:
        rumble(loaded["learn"], loaded["choose"])
