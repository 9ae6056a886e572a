#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Learns lib/sound/onset_weights.h and rumble_weights.h, from real sounds (real_sounds.py) and some synthetic ones, and writes them.

A mix has a bed (music, speech, both, ambience, noise or silence) and effects at −8 to +16 dB, in rooms, through filters, faster and
slower, limited, coded, at −30 to −1 dB of full scale. Each effect is a bag of moments about its onset; the most probable stands for it,
chosen again in each epoch. One hidden layer; the threshold is where the music of the set for choosing has PER_MINUTE impacts.

Usage: OMP_NUM_THREADS=1 tests/sound/train.py BUILD CACHE      BUILD: a build folder with tests/sound/sound_features; CACHE: keeps packages
and sounds. About 15 minutes of one core. Needs ffmpeg, python3-scipy and apt-get."""

import pathlib
import pickle
import subprocess
import sys

import numpy as np
from real_sounds import RATE, bed_of, coded, limited, mixed, sounds
from scipy.optimize import minimize

HIDDEN = 24
EPOCHS = 10
SEEDS = (1,)
PER_MINUTE = 5.0
RUMBLE_IN_MUSIC = 0.04
DEAD_S = 0.15  # OnsetDetector::kDeadHops
FILM_S = 60
LEARN = {"music": 14, "speech": 5, "both": 5, "silence": 6, "noise": 2, "ambient": 3}
ALONE = {"music": 16, "speech": 6, "ambient": 3}
CHOOSE = {"music": 3, "speech": 1, "silence": 1}
CHOOSE_ALONE = {"music": 4, "speech": 2}

root = pathlib.Path(__file__).resolve().parents[2]
build, cache = map(pathlib.Path, sys.argv[1:3])


def finish(samples, rng):
    if rng.random() < 0.5:
        samples = limited(samples, rng)
    if rng.random() < 0.08:
        codec, rate = [("libvorbis", "40k"), ("aac", "48k"), ("libopus", "32k")][rng.integers(3)]
        samples = coded(samples, codec, rate, cache)
    return samples * 10 ** (rng.uniform(-30, -1) / 20) / (np.abs(samples).max() + 1e-9)


def films(of, plan, alone, rng):
    """(samples, onsets, name) of each film."""
    effects = [s for kind, times in (("explosion", 3), ("impact", 1), ("gun", 2), ("footstep", 1)) for s in of.get(kind, []) * times]
    for kind, count in plan.items():
        for i in range(count):
            samples, truth = mixed(bed_of(kind, of, FILM_S, rng), effects, lambda: rng.uniform(-8, 16), rng)
            yield finish(samples, rng), [at for at, *_ in truth], kind
    for kind, count in alone.items():
        for i in range(count):
            yield finish(bed_of(kind, of, FILM_S, rng), rng), [], kind + " alone"


def synthetic(seed):
    """Of tests/sound's synthetic sounds."""
    for i, what in enumerate(["impacts", "impacts", "explosions", "impacts+0", "impacts+6", "music", "music"]):
        made = subprocess.run([build / "tests/sound/sound_features", "make", str(seed + i), what, cache / "made.f32"], check=True, stdout=subprocess.PIPE, text=True)
        yield np.fromfile(cache / "made.f32", "<f4"), [float(line) for line in made.stdout.split()], "synthetic " + what


def features(samples, of):
    (cache / "film.f32").write_bytes(samples.astype("<f4").tobytes())
    out = subprocess.run([build / "tests/sound/sound_features", of, cache / "film.f32"], check=True, stdout=subprocess.PIPE)
    return np.frombuffer(out.stdout, "<f4")


class Moments:
    """Those at which an impact may begin."""

    def __init__(self, made, of, width):
        rows, seconds, bag, film, kinds, offset, bags = [], [], [], [], [], 0, 0
        for samples, truth, kind in made:
            read = features(samples, of).reshape(-1, width + 1)
            at = read[:, 0] * 0.005
            mine = np.zeros(len(at), np.int32)
            for onset in truth:
                bags += 1
                mine[(at > onset - 0.06) & (at < onset + 0.16) & (mine == 0)] = -1
                mine[(at > onset - 0.011) & (at < onset + 0.041)] = bags
            rows.append(read[:, 1:])
            seconds.append(at + offset)
            bag.append(mine)
            film.append(np.full(len(at), len(kinds)))
            kinds.append((kind, len(samples) / RATE, offset, truth))
            offset += len(samples) / RATE + 1
        self.rows, self.seconds, self.bag, self.film = map(np.concatenate, (rows, seconds, bag, film))
        self.kinds = kinds
        print(f"{len(self.rows)} moments, {len(np.unique(self.bag[self.bag > 0]))} of {bags} impacts", flush=True)


def forward(net, x):
    hidden = np.maximum(x @ net["w"] + net["b"], 0)
    return hidden, hidden @ net["v"] + net["c"]


def scaled(rows, mean, spread):
    return np.clip((rows - mean) / spread, -4, 4)


def best_of_bags(moments, score):
    ours = np.flatnonzero(moments.bag > 0)
    ours = ours[np.lexsort((-score[ours], moments.bag[ours]))]
    return ours[np.unique(moments.bag[ours], return_index=True)[1]]


def learn(moments, seed):
    rng = np.random.default_rng(seed)
    mean, spread = moments.rows.mean(axis=0), moments.rows.std(axis=0) + 1e-3
    x = scaled(moments.rows, mean, spread)
    others = np.flatnonzero(moments.bag == 0)
    speech = np.array(["speech" in kind or "both" in kind for kind, *_ in moments.kinds])[moments.film]
    width = x.shape[1]
    net = {"w": rng.normal(0, (1 / width) ** 0.5, (width, HIDDEN)), "b": np.zeros(HIDDEN), "v": rng.normal(0, HIDDEN**-0.5, HIDDEN), "c": np.array(-1.0)}
    net = {k: v.astype(np.float32) for k, v in net.items()}
    adam = {k: [np.zeros_like(v), np.zeros_like(v)] for k, v in net.items()}
    step = 0
    score = x[:, 73]  # the flux
    for epoch in range(EPOCHS):
        blows = best_of_bags(moments, score)
        # Those that are taken for impacts count more.
        hard = others[score[others] > np.quantile(score[others], 0.9)] if epoch else others
        order = rng.permutation(others)
        batches = max(1, len(order) // 1792)
        rate = 0.003 * (1 - epoch / EPOCHS) + 1e-4
        for i in range(batches):
            pick = np.concatenate([rng.choice(blows, 256), order[i * 1792 :][:1792], rng.choice(hard, 512)])
            y = np.zeros(len(pick), np.float32)
            y[:256] = 1
            weight = np.where(y > 0, 2.0, np.where(speech[pick], 1.5, 1.0)).astype(np.float32)
            xs = x[pick]
            hidden, out = forward(net, xs)
            error = weight * (1 / (1 + np.exp(-out)) - y) / len(pick)
            back = np.outer(error, net["v"]) * (hidden > 0)
            slopes = {"w": xs.T @ back + 3e-5 * net["w"], "b": back.sum(0), "v": hidden.T @ error + 3e-5 * net["v"], "c": error.sum()}
            step += 1
            for k, slope in slopes.items():
                m, s = adam[k]
                m += 0.1 * (slope - m)
                s += 0.001 * (slope**2 - s)
                net[k] = net[k] - (rate * m / (1 - 0.9**step) / (np.sqrt(s / (1 - 0.999**step)) + 1e-8)).astype(np.float32)
        score = forward(net, x)[1]
    # The scaling becomes part of the weights, but for the clipping.
    return dict(net, mean=mean, spread=spread)


def scores(net, rows):
    return forward(net, scaled(rows, net["mean"], net["spread"]))[1]


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


def report(moments, score, least):
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
    for kind, (right, count, truths, seconds) in result.items():
        print(f"  {kind}: " + (f"F1 {2 * right / (count + truths):.3f}, recall {right / truths:.3f}" if truths else f"{count * 60 / seconds:.2f} a minute"), flush=True)


def threshold(moments, score, kind, most):
    for least in np.arange(-6, 12, 0.05):
        if rate_of(moments, score, least, kind) <= most:
            return least
    return 12


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
            + array(prefix + "HiddenOffset", net["b"]) + array(prefix + "Out", net["v"]) + f"inline constexpr float {prefix}Offset = {net['c'] - least:.4f}F;\n")


def onsets(learned, chosen):
    body = ""
    for name, prefix in (("soon", "kOnset"),):
        width = 93 if name == "soon" else 129
        moments, judges = Moments(learned, name, width), Moments(chosen, name, width)
        nets = [learn(moments, seed) for seed in SEEDS]
        best = max(nets, key=lambda net: f1_at(judges, net))
        score = scores(best, judges.rows)
        least = threshold(judges, score, "music alone", PER_MINUTE)
        for most in (2, 5, 10):
            at = threshold(judges, score, "music alone", most)
            print(f"{name}, {most} a minute: above {at:.2f}", flush=True)
            report(judges, score, at)
        print("learned:")
        report(moments, scores(best, moments.rows), least)
        body += network(prefix, best, least)
    write("onset_weights.h", "One hidden layer for moments that are known soon, and one for those known later.", body)


def f1_at(judges, net):
    score = scores(net, judges.rows)
    least = threshold(judges, score, "music alone", PER_MINUTE)
    right = count = truths = 0
    for i, (kind, seconds, offset, truth) in enumerate(judges.kinds):
        if truth:
            at = found(judges.seconds[judges.film == i], score[judges.film == i], least) - offset
            right += sum(any(abs(t - onset) <= 0.05 for t in at) for onset in truth)
            count += len(at)
            truths += len(truth)
    return 2 * right / (count + truths)


def rumble_films(of, rng, minutes):
    """(samples, whether it is rumble)"""
    deep = of["engine"] + of["explosion"]
    for i in range(minutes):
        bed = bed_of(("silence", "music", "speech")[i % 3], of, FILM_S, rng)
        samples, truth = mixed(bed, deep, lambda: rng.uniform(0, 12), rng, (2.5, 4))
        hops = np.zeros(len(samples) // 80, bool)
        for at, *_ in truth:
            hops[int(at * 200) : int(at * 200 + 300)] = True
        yield finish(samples, rng), hops, "rumble over " + ("silence", "music", "speech")[i % 3]
    for kind in ("music", "speech", "both"):
        for i in range(minutes // 2):
            yield finish(bed_of(kind, of, FILM_S, rng), rng), np.zeros(FILM_S * 200, bool), kind + " alone"


def rumble(learn_from, choose_from):
    def read(of, seed, minutes):
        rng = np.random.default_rng(seed)
        x, y, kinds, hops = [], [], [], {}
        for samples, is_deep, kind in rumble_films(of, np.random.default_rng(seed), minutes):
            rows = features(samples * 10 ** (rng.uniform(6, 20) / 20), "rumble").reshape(-1, 10)[:, 1:]
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
    write("rumble_weights.h", "What RumbleFeatures has after the first, and how much of each.",
          array("kRumbleMean", mean) + array("kRumbleScale", 1 / spread) + array("kRumbleWeights", w[:-1]) + f"inline constexpr float kRumbleOffset = {w[-1] - least:.4f}F;\n")


if __name__ == "__main__":
    learn_from, choose_from = sounds("learn", cache), sounds("choose", cache)
    kept = cache / "films.pickle"
    if not kept.exists():
        learned = list(films(learn_from, LEARN, ALONE, np.random.default_rng(1))) + list(synthetic(1))
        chosen = list(films(choose_from, CHOOSE, CHOOSE_ALONE, np.random.default_rng(2)))
        kept.write_bytes(pickle.dumps((learned, chosen)))
    onsets(*pickle.loads(kept.read_bytes()))
    rumble(learn_from, choose_from)
