#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Learns lib/sound/onset_weights.h and rumble_weights.h, from real sounds (real_sounds.py) and some synthetic ones, and writes them.

A mix has a bed (music, speech, both, ambience, noise or silence) and effects at −8 to +16 dB, in rooms, through filters, faster and
slower, limited, coded, at −40 to −1 dB of full scale. Each effect is a bag of moments about its onset; the most probable stands for it,
chosen again in each epoch. Each of two networks, without and with later features, has one hidden layer. Of several starts the best one is
taken, and the threshold is where the music of the set for choosing has PER_MINUTE impacts.

Usage: OMP_NUM_THREADS=1 tests/sound/train.py BUILD CACHE [CORES] [tune]      BUILD: a build folder with tests/sound/sound_features;
CACHE: keeps packages and sounds; tune: goes on from the weights that are there, instead of anew. About an hour of a core. Needs
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
from scipy.signal import lfilter

HIDDEN = 48
EPOCHS = 12
TUNE_EPOCHS = 6
SEEDS = (1, 2, 3)
BATCH, POSITIVES, HARD = 1792, 256, 512
OF_IMPACTS = 2.0  # weights; others' are 1
# Names, features, weights of speech, and impacts a minute in music; other music gives up to twice as many.
NETWORKS = (("Onset", 99, 5.0, 4.0), ("Later", 139, 1.5, 2.0))
# As OnsetDetector: the feature, from where to where, and how much less of a score is enough.
RISE, STANDS_OUT, STANDS_ALONE, ALONE = 108, 15, 40, 4.0
# As OnsetDetector: the score of three moments in a row, which is within ± MOST.
IN_ROW, MOST = 3, 8.0
FLUX = 67  # the feature
RUMBLE_IN_MUSIC = 0.05
RUMBLE_HIDDEN, SCORE_S = 8, 0.4
DEAD_S = 0.15  # OnsetDetector::kDeadHops
FILM_S = 60
LEARN = {"music": 90, "speech": 12, "both": 15, "dialog": 36, "silence": 36, "noise": 8, "ambient": 12}
LEARN_ALONE = {"music": 120, "speech": 18, "both": 15, "dialog": 48, "ambient": 12}
CHOOSE = {"music": 24, "speech": 8, "dialog": 6, "silence": 6}
CHOOSE_ALONE = {"music": 40, "speech": 10, "dialog": 14, "both": 4}
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
    return samples * 10 ** (rng.uniform(-40, -1) / 20) / (np.abs(samples).max() + 1e-9)


def film(name, kind, ratio, seed, folder):
    """Samples, onsets and name. `ratio`: None for no effects, True for any."""
    of = loaded[name]
    rng = np.random.default_rng(seed)
    bed = bed_of(kind, of, FILM_S, rng)
    if kind == "silence" and rng.random() < 0.5:  # a room
        bed = bed_of("noise", of, FILM_S, rng) * 10 ** (-rng.uniform(15, 50) / 20)
    if ratio is None:
        return finish(bed, rng, folder), [], kind + " alone"
    effects = [s for k, times in TIMES.items() for s in of.get(k, []) * times]
    ratios = (lambda: rng.uniform(-8, 16)) if ratio is True else ratio
    if kind == "silence":
        samples, truth = mixed(np.zeros_like(bed), effects, ratios, rng)
        samples += bed
    else:
        samples, truth = mixed(bed, effects, ratios, rng)
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
    return np.clip((rows[:, : len(net["mean"])] - net["mean"]) / net["spread"], -4, 4).astype(np.float32)


def scores(net, x):
    return np.concatenate([forward(net, x[i : i + 65536])[1] for i in range(0, len(x), 65536)])


def judged_score(moments, nets):
    """Of each moment the mean of the last three, and of the networks."""
    score = sum(np.clip(scores(net, scaled(moments.rows, net)), -MOST, MOST) for net in nets) / len(nets)
    total = score.copy()
    for back in range(1, IN_ROW):
        is_next = np.abs(moments.seconds[back:] - moments.seconds[:-back] - 0.005 * back) < 0.001
        total[:back] -= MOST
        total[back:] += np.where(is_next, score[:-back], -MOST)
    return total / IN_ROW + ALONE * np.clip((moments.rows[:, RISE] - STANDS_OUT) / (STANDS_ALONE - STANDS_OUT), 0, 1)


def best_of_bags(moments, score):
    ours = np.flatnonzero(moments.bag > 0)
    ours = ours[np.lexsort((-score[ours], moments.bag[ours]))]
    return ours[np.unique(moments.bag[ours], return_index=True)[1]]


def present(prefix):
    """A network in the tree."""
    text = (root / "lib/sound/onset_weights.h").read_text()
    found = {name: np.array([float(value.strip(" F\n")) for value in values.split(",")], np.float32) for name, values in re.findall(rf"k{prefix}(\w+)\{{(.*?)\}};", text, re.S)}
    units = len(found["Out"])
    return {"mean": found["Mean"], "spread": 1 / found["Scale"], "w": (found["Hidden"].reshape(units, -1) * found["HiddenScale"][:, None]).T.copy(), "b": found["HiddenOffset"],
            "v": found["Out"], "c": np.float32(re.search(rf"k{prefix}Offset = ([-.\d]+)F", text)[1])}


def learn(moments, seed, width, of_speech, start=None, hidden=HIDDEN, of_impacts=OF_IMPACTS):
    epochs, first_rate = (TUNE_EPOCHS, 0.001) if start else (EPOCHS, 0.003)
    rng = np.random.default_rng(seed)
    net = start or {"w": rng.normal(0, width**-0.5, (width, hidden)), "b": np.zeros(hidden), "v": rng.normal(0, hidden**-0.5, hidden), "c": np.array(-1.0)}
    net = {k: v.astype(np.float32) for k, v in net.items()}
    adam = {k: [np.zeros_like(net[k]), np.zeros_like(net[k])] for k in "wbvc"}
    if not start:
        net |= {"mean": moments.rows[:, :width].mean(axis=0), "spread": moments.rows[:, :width].std(axis=0) + 1e-3}
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


def array(name, values, kind="float"):
    numbers = [f"{value:.4g}" for value in np.ravel(values)]
    if kind == "float":
        numbers = [n + ("F" if set(n) & set(".e") else ".F") for n in numbers]
    return f"inline constexpr std::array<{kind}, {np.size(values)}> {name}{{ " + ", ".join(numbers) + " };\n"


def write(name, comment, body):
    file = root / "lib/sound" / name
    file.write_text(f"// SPDX-License-Identifier: LGPL-2.1-or-later\n//\n// Made by tests/sound/train.py; do not edit.\n#pragma once\n\n#include <array>\n#include <cstdint>\n\n"
                    f"/// {comment}\nnamespace sound {{\n\n{body}\n}} // namespace sound\n")
    subprocess.run(["clang-format-14", "-i", file], check=True)


def network(prefix, net, least):
    scale = np.abs(net["w"]).max(axis=0) / 127
    return (array(prefix + "Mean", net["mean"]) + array(prefix + "Scale", 1 / net["spread"]) + array(prefix + "Hidden", np.round(net["w"] / scale).T, "std::int8_t")
            + array(prefix + "HiddenScale", scale) + array(prefix + "HiddenOffset", net["b"]) + array(prefix + "Out", net["v"])
            + f"inline constexpr float {prefix}Offset = {net['c']:.4f}F;\n/// The mean score of an impact is above.\ninline constexpr float {prefix}Least = {least:.4f}F;\n")


def jobs_of(name, plan, alone, ratios, seed):
    jobs = [(film, name, kind, ratios[i % len(ratios)]) for kind, count in plan.items() for i in range(count)]
    jobs += [(film, name, kind, None) for kind, count in alone.items() for _ in range(count)]
    return [(*job, (seed, i)) for i, job in enumerate(jobs)]


def read(pool):
    made = ("impacts", "impacts", "explosions", "impacts+0", "impacts+6", "music", "music")
    learned = Moments(jobs_of("learn", LEARN, LEARN_ALONE, (True,), 1) + [(synthetic, what, 1 + i) for i, what in enumerate(made)], pool)
    return learned, Moments(jobs_of("choose", CHOOSE, CHOOSE_ALONE, CHOOSE_RATIOS, 2), pool)


def worth(moments, nets, per_minute):
    """The mean F1, and the threshold."""
    score = judged_score(moments, nets)
    least = threshold(moments, score, per_minute)
    result = judged(moments, score, least)
    print(f"above {least:.2f}:", ", ".join(f"{kind} {value:.2f}" for kind, value in result.items()), flush=True)
    return np.mean([value for kind, value in result.items() if "alone" not in kind]), least


def impacts(moments, judges, tune):
    chosen, body = [], ""
    for name, width, of_speech, per_minute in NETWORKS:
        found = []
        for seed in (1,) if tune else SEEDS:
            net = learn(moments, seed, width, of_speech, present(name) if tune else None)
            found.append((*worth(judges, [*chosen, net], per_minute), net))
        _, least, net = max(found, key=lambda one: one[0])
        chosen.append(net)
        body += ("\n" if body else "") + network("k" + name, net, least)
    write("onset_weights.h", "One hidden layer of what OnsetFeatures knows, without and with its later features.", body)


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

    x, y, kinds, hops = read(learn_from, 3, 27)
    mean, spread = x.mean(axis=0), x.std(axis=0) + 1e-3
    xs = np.clip((x - mean) / spread, -3, 3)
    weight = np.where(y, 1 / y.sum(), 1 / (~y).sum())
    parts = np.cumsum([xs.shape[1] * RUMBLE_HIDDEN, RUMBLE_HIDDEN, RUMBLE_HIDDEN])

    def layers(w):
        hidden, offset, out, last = np.split(w, parts)
        return hidden.reshape(RUMBLE_HIDDEN, -1), offset, out, last[0]

    def loss(w):
        hidden, offset, out, last = layers(w)
        inner = np.maximum(xs @ hidden.T + offset, 0)
        score = inner @ out + last
        error = weight * (1 / (1 + np.exp(-score)) - y)
        back = np.outer(error, out) * (inner > 0)
        slope = np.concatenate([(back.T @ xs).ravel(), back.sum(0), inner.T @ error, [error.sum()]])
        return (weight * (np.logaddexp(0, score) - y * score)).sum() + 1e-4 * (w**2).sum(), slope + 2e-4 * w

    w = minimize(loss, np.random.default_rng(1).normal(0, 0.3, parts[-1] + 1), jac=True, method="L-BFGS-B", options={"maxiter": 400}).x
    hidden, offset, out, last = layers(w)
    x, y, kinds, hops = read(choose_from, 4, 12)
    score = np.clip(np.maximum(np.clip((x - mean) / spread, -3, 3) @ hidden.T + offset, 0) @ out + last, -MOST, MOST)
    score = lfilter([0.005 / SCORE_S], [1, 0.005 / SCORE_S - 1], score)
    least = np.quantile(np.concatenate([score[kinds == "music alone"], np.full(hops["music alone"] - (kinds == "music alone").sum(), -99)]), 1 - RUMBLE_IN_MUSIC)
    for kind, count in hops.items():
        print(f"  {kind}: {100 * (score[kinds == kind] > least).sum() / count:.1f} % of the time, deep {100 * (kinds == kind).sum() / count:.0f} %")
    write("rumble_weights.h", "One hidden layer of RumbleFeatures after the first.",
          array("kRumbleMean", mean) + array("kRumbleScale", 1 / spread) + array("kRumbleHidden", hidden) + array("kRumbleHiddenOffset", offset) + array("kRumbleOut", out)
          + f"inline constexpr float kRumbleOffset = {last - least:.4f}F;\n")


if __name__ == "__main__":
    loaded.update({name: sounds(name, cache) for name in ("learn", "choose")})
    tune = "tune" in sys.argv
    with multiprocessing.Pool(int(sys.argv[3]) if len(sys.argv) > 3 + tune else 1) as pool:
        impacts(*read(pool), tune)
    if not tune:
        rumble(loaded["learn"], loaded["choose"])
