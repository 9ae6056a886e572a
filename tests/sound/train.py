#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Learns lib/sound/onset_weights.h and rumble_weights.h, from real sounds (real_sounds.py) and some synthetic ones, and writes them.

A mix has a bed (music, speech, both, ambience, noise or silence) and effects at −8 to +16 dB, in rooms, through filters, faster and
slower, limited, coded, at −40 to −1 dB of full scale. Each effect is a bag of moments about its onset; the most probable stands for it,
chosen again in each epoch. Each of two networks, without and with later features, has one hidden layer. Of several starts the best one is
taken, and the threshold is where the music of the set for choosing has PER_MINUTE impacts.

Usage: OMP_NUM_THREADS=1 tests/sound/train.py BUILD CACHE [CORES] [tune|rumble]      BUILD: a build folder with tests/sound/sound_features;
CACHE: keeps packages and sounds; tune: impacts only, from the weights that are there instead of anew. About an hour of a core. Needs
ffmpeg, python3-scipy and apt-get."""

import multiprocessing
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
from real_sounds import RATE, bed_of, boom_of, coded, faster, limited, low_pass, mixed, sounds
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
# Names, features, films not learned from, and the share of the music for choosing that is felt.
RUMBLE_NETWORKS = (("Engine", 15, ("boom", "wind alone", "wind and music alone", "wind and dialog alone"), 0.03), ("Boom", 18, (), 0.01))
RUMBLE = {"boom": 1, "engine": 1, "explosion": 0.7}  # what rumbles
OVER = {"silence": 7, "music": 12, "speech": 3, "both": 4, "dialog": 5, "ambient": 2, "wind": 4}
NO_RUMBLE = {"music": 26, "speech": 6, "both": 8, "dialog": 10, "wind": 32, "wind and music": 10, "wind and dialog": 8}
NO_RUMBLE_WEIGHTS = {"music": 3, "speech": 1, "both": 1.5, "dialog": 1.5, "wind": 1, "wind and music": 0.7, "wind and dialog": 0.5}
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


def made_in_folder(job):
    make, *arguments = job
    with tempfile.TemporaryDirectory() as folder:
        return make(*arguments, pathlib.Path(folder))


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


def rumbles(what, of, rng):
    """What rumbles, alone: engines, explosions or booms."""
    out = np.zeros(FILM_S * RATE, np.float32)
    at = rng.uniform(0.5, 3)
    while at < FILM_S - 1:
        if what == "boom":
            samples = boom_of(of, rng)
        else:
            samples = faster(of[what][rng.integers(len(of[what]))].samples, rng.uniform(0.5, 1.6))
            if rng.random() < 0.3:
                samples = low_pass(samples, 100 * 20 ** rng.random())
            samples = np.resize(samples, max(len(samples), 3 * RATE if what == "engine" else 0))[: 8 * RATE]
        fade = min(len(samples) // 4, RATE // 20)
        samples[-fade:] *= np.linspace(1, 0, fade)
        parts = np.array_split(samples, max(1, len(samples) // (RATE // 5)))
        samples *= 0.1 * 10 ** (rng.uniform(-3, 15) / 20) / (max(np.sqrt((part**2).mean()) for part in parts) + 1e-9)
        begin = int(at * RATE)
        out[begin : begin + len(samples)] += samples[: len(out) - begin]
        at += (1 if what == "engine" else 0.7) * len(samples) / RATE + rng.uniform(0.7, 3)
    return out


def rumble_film(name, what, kind, seed, folder):
    """Features; where they are rumble: 1, where not: 0; and what the film is. Rumble is what is deeper than the bed by 1 dB; −1 to 8 dB less is neither."""
    of = loaded[name]
    rng = np.random.default_rng(seed)
    bed = bed_of("noise" if kind == "silence" else kind, of, FILM_S, rng) * (10 ** (-rng.uniform(20, 60) / 20) if kind == "silence" else 1)
    own = rumbles(what, of, rng) if what else 0 * bed
    samples = limited(bed + own, rng) if rng.random() < 0.4 else bed + own
    gain = 10 ** ((rng.uniform(-30, -1) + rng.uniform(6, 20)) / 20) / np.abs(samples).max()
    rows, *deep = (features(gain * part, "rumble", folder)[200:, 1:] for part in (samples, *([own, bed] if what else [])))
    is_rumble = np.zeros(len(rows), np.int8)
    if what:
        more = deep[0][:, 0] - deep[1][:, 0]
        is_rumble = np.select([more > 1, more > -8], [1, -1], 0)
    return rows[is_rumble >= 0], is_rumble[is_rumble >= 0] > 0, f"{what} over {kind}" if what else f"{kind} alone"


def rumble_films(name, seed, part, pool):
    """Features, whether they are rumble, their films, what these are."""
    jobs = [(rumble_film, name, what, kind) for what, times in RUMBLE.items() for kind, count in OVER.items() for _ in range(round(part * times * count))]
    jobs += [(rumble_film, name, None, kind) for kind, count in NO_RUMBLE.items() for _ in range(round(part * count))]
    jobs = [(*job, (seed, i)) for i, job in enumerate(jobs) if job[3] != "ambient" or "ambient" in loaded[name]]
    films = list(pool.imap(made_in_folder, jobs))
    return *(np.concatenate([film[i] for film in films]) for i in (0, 1)), np.repeat(np.arange(len(films)), [len(film[1]) for film in films]), [film[2] for film in films]


def rumble_network(x, y, group, alone):
    """Its layers, mean and spread. All kinds of rumble weigh the same, and as much as all that is none."""
    rng = np.random.default_rng(1)
    weight = np.zeros(len(x))
    for name in set(group):
        of = group == name
        weight[of & y] = 1 / max(1, (of & y).sum())
        weight[of & ~y] = alone.get(name.removesuffix(" alone"), 0.1) / max(1, (of & ~y).sum())
    weight[y] /= weight[y].sum()
    weight[~y] /= weight[~y].sum()
    pick = rng.choice(len(x), min(len(x), 150000), p=weight / weight.sum())
    x, y = x[pick], y[pick]
    mean, spread = x.mean(axis=0), x.std(axis=0) + 1e-3
    xs = np.clip((x - mean) / spread, -3, 3).astype(float)
    parts = np.cumsum([xs.shape[1] * RUMBLE_HIDDEN, RUMBLE_HIDDEN, RUMBLE_HIDDEN])

    def layers(w):
        hidden, offset, out, last = np.split(w, parts)
        return hidden.reshape(RUMBLE_HIDDEN, -1), offset, out, last[0]

    def loss(w):
        hidden, offset, out, last = layers(w)
        inner = np.maximum(xs @ hidden.T + offset, 0)
        score = inner @ out + last
        error = (1 / (1 + np.exp(-score)) - y) / len(y)
        back = np.outer(error, out) * (inner > 0)
        slope = np.concatenate([(back.T @ xs).ravel(), back.sum(0), inner.T @ error, [error.sum()]])
        return (np.logaddexp(0, score) - y * score).mean() + 1e-4 * (w**2).sum(), slope + 2e-4 * w

    w = minimize(loss, rng.normal(0, 0.3, parts[-1] + 1), jac=True, method="L-BFGS-B", options={"maxiter": 400}).x
    return *layers(w), mean, spread


def rumble(pool):
    x, y, film, kinds = rumble_films("learn", 3, 1, pool)
    group = np.array([kind.split()[0] if " over " in kind else kind for kind in kinds])[film]
    cx, cy, films, kinds = rumble_films("choose", 4, 0.5, pool)
    kind = np.array(kinds)[films]
    loud = cx[:, 0] > -36
    body, felt = "", np.zeros(len(cx), bool)
    for name, count, apart, in_music in RUMBLE_NETWORKS:
        of = (x[:, 0] > -40) & ~np.isin(group, apart)
        hidden, offset, out, last, mean, spread = rumble_network(x[of, 1 : count + 1], y[of], group[of], NO_RUMBLE_WEIGHTS)
        score = np.clip(np.maximum(np.clip((cx[:, 1 : count + 1] - mean) / spread, -3, 3) @ hidden.T + offset, 0) @ out + last, -MOST, MOST)
        for i in range(len(kinds)):
            score[films == i] = lfilter([0.005 / SCORE_S], [1, 0.005 / SCORE_S - 1], score[films == i])
        least = np.quantile(np.where(loud, score, -99)[kind == "music alone"], 1 - in_music)
        felt |= loud & (score > least)
        body += ("\n" if body else "") + array(f"k{name}Mean", mean) + array(f"k{name}Scale", 1 / spread) + array(f"k{name}Hidden", hidden)
        body += array(f"k{name}HiddenOffset", offset) + array(f"k{name}Out", out) + f"inline constexpr float k{name}Offset = {last - least:.4f}F;\n"
    for name in sorted(set(kinds)):
        of = (kind == name) & (cy | ("alone" in name))
        print(f"  {name}: {100 * felt[of].mean():.1f} % of the time, deep {100 * loud[of].mean():.0f} %", flush=True)
    write("rumble_weights.h", "One hidden layer each of RumbleFeatures after the first: for engines and explosions, which has only the first 15, and for booms.", body)


if __name__ == "__main__":
    loaded.update({name: sounds(name, cache) for name in ("learn", "choose")})
    only = sys.argv[-1] if sys.argv[-1] in ("tune", "rumble") else None
    with multiprocessing.Pool(int(sys.argv[3]) if len(sys.argv) > 3 + (only is not None) else 1) as pool:
        if only != "rumble":
            impacts(*read(pool), only == "tune")
        if only != "tune":
            rumble(pool)
