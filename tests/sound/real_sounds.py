#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Real sounds of Debian packages, and mixes of them as a film has them.

real_sounds.csv names them, by package and file; their classes were chosen by file name, unheard. No package's effects, music or
speech are in two of the sets."""

import csv
import fnmatch
import pathlib
import subprocess
import zipfile

import numpy as np
from scipy.signal import butter, fftconvolve, lfilter, sosfilt

RATE = 16000
IMPACTS = ("explosion", "impact", "gun", "footstep")
MUSIC_S = 24  # of each piece

here = pathlib.Path(__file__).resolve().parent


def fetch(package, cache):
    """Unpacks a package; nothing of it is kept elsewhere."""
    folder = cache / "x" / package
    if not folder.exists():
        (cache / "deb").mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", "-q", package], cwd=cache / "deb", check=True)
        folder.mkdir(parents=True)
        subprocess.run(["dpkg", "-x", next((cache / "deb").glob(f"{package}_*.deb")), folder], check=True)
        for archive in folder.rglob("*.pk3"):
            zipfile.ZipFile(archive).extractall(archive.parent)
    return folder


def decoded(file, cache, begin=0, seconds=10):
    """Mono samples at RATE."""
    kept = cache / "pcm" / (str(file.relative_to(cache)).replace("/", "+") + ".npy")
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        raw = subprocess.run(["ffmpeg", "-v", "quiet", "-ss", str(begin), "-t", str(seconds), "-i", file, "-ac", "1", "-ar", str(RATE), "-f", "f32le", "-"],
                             stdout=subprocess.PIPE)
        np.save(kept, np.frombuffer(raw.stdout, "<f4"))
    return np.load(kept)[: seconds * RATE]


class Sound:
    def __init__(self, samples, name):
        peak = np.abs(samples).max()
        self.name = name
        self.samples = (samples / peak).astype(np.float32)


def sounds(name, cache):
    """{class: [Sound]} of a set."""
    result = {}
    for row in csv.DictReader(open(here / "real_sounds.csv")):
        if row["set"] != name:
            continue
        folder = fetch(row["package"], cache)
        files = sorted(f for f in folder.rglob("*") if f.suffix in (".wav", ".ogg", ".mp3", ".wv") and f.is_file())
        patterns = [p if "/" in p else "*/" + p for p in row["files"].split()]
        of = result.setdefault(row["class"], [])
        for file in files:
            if not any(fnmatch.fnmatchcase(str(file.with_suffix("")), p) for p in patterns):
                continue
            music = row["class"] == "music"
            samples = decoded(file, cache, 8 if music else 0, MUSIC_S if music else 10)
            if len(samples) > RATE // 20 and np.abs(samples).max() > 1e-4:
                of.append(Sound(samples, f"{row['package']}/{file.name}"))
    return result


def onset_of(samples):
    """Where the first 5 ms are that are within 15 dB of the loudest, s."""
    hop = RATE // 200
    power = (samples[: len(samples) // hop * hop].reshape(-1, hop) ** 2).mean(axis=1)
    return int(np.argmax(power > power.max() * 10**-1.5)) * hop


def band_pass(samples, low, high):
    sections = [butter(1, low, "highpass", fs=RATE, output="sos")] if low else []
    sections += [butter(2, high, "lowpass", fs=RATE, output="sos")] if high else []
    return sosfilt(np.vstack(sections), samples).astype(np.float32) if sections else samples


def room(samples, rng, seconds, direct):
    """In a room with that reverberation time."""
    n = int(RATE * min(seconds, 0.8))
    tail = rng.standard_normal(n) * 10 ** (-3 * np.arange(n) / (RATE * seconds))
    tail /= np.sqrt((tail**2).sum())
    out = samples.copy()
    wet = fftconvolve(samples, tail)[: len(samples)]
    return (out + direct * wet).astype(np.float32)


def faster(samples, speed):
    at = np.arange(0, len(samples) - 1, speed)
    return np.interp(at, np.arange(len(samples)), samples).astype(np.float32)


def limited(samples, rng):
    """As a film's mix: a slow compressor, then a soft limit."""
    hop = RATE // 100
    power = (samples[: len(samples) // hop * hop].reshape(-1, hop) ** 2).mean(axis=1)
    smooth = lfilter([0.03], [1, -0.97], power) + 1e-6
    gain = np.minimum(1, (smooth / np.median(smooth)) ** -rng.uniform(0.05, 0.2))
    out = samples * np.interp(np.arange(len(samples)), np.arange(len(gain)) * hop, gain)
    knee = np.percentile(np.abs(out), rng.uniform(99, 99.95)) + 1e-6
    return (np.tanh(out / knee) * knee).astype(np.float32)


def coded(samples, codec, rate, cache):
    """Through a lossy codec; where its delay is not taken out, here."""
    raw = cache / "coded.f32"
    file = cache / ("coded.ogg" if codec in ("libvorbis", "libopus") else "coded.m4a")
    peak = np.abs(samples).max() + 1e-9
    (samples / peak * 0.7).astype("<f4").tofile(raw)
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "f32le", "-ar", str(RATE), "-ac", "1", "-i", raw, "-c:a", codec, "-b:a", rate, file], check=True)
    out = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-f", "f32le", "-ac", "1", "-ar", str(RATE), "-"], check=True, stdout=subprocess.PIPE)
    out = np.frombuffer(out.stdout, "<f4")[: len(samples)] * peak / 0.7
    return np.concatenate([out, np.zeros(len(samples) - len(out))]).astype(np.float32)


def dialog_of(of, seconds, rng):
    """Speech as films have it: near or far in a room, with puffs of breath, over music and what is heard of the place."""
    speech = faster(bed_of("speech", of, 1.3 * seconds, rng), rng.uniform(0.8, 1.25))[: int(seconds * RATE)]
    if rng.random() < 0.3:  # puffs of breath, of plosives
        for at in np.cumsum(rng.exponential(2, int(seconds / 2))):
            begin = int(at * RATE)
            n = int(RATE * rng.uniform(0.02, 0.1))
            if begin + n < len(speech) and np.abs(speech[begin : begin + n]).max() > 0.02:
                puff = band_pass(rng.standard_normal(n).astype(np.float32), 20, rng.uniform(60, 300)) * np.hanning(n)
                speech[begin : begin + n] += puff * (0.1 * 10 ** (rng.uniform(-10, 6) / 20) / (np.sqrt((puff**2).mean()) + 1e-9))
    if rng.random() < 0.7:
        speech = room(speech, rng, 0.15 * 8 ** rng.random(), rng.uniform(0.1, 1.0))
    if rng.random() < 0.4:
        speech = band_pass(speech, rng.uniform(60, 250), rng.uniform(3000, 7500))
    speech = speech * 0.1 / np.sqrt((speech**2).mean())
    place = bed_of("ambient" if "ambient" in of and rng.random() < 0.5 else "noise", of, seconds, rng) * 10 ** (-rng.uniform(10, 35) / 20)
    return speech + place + (bed_of("music", of, seconds, rng) * 10 ** (-rng.uniform(-2, 20) / 20) if rng.random() < 0.8 else 0)


def bed_of(kind, of, seconds, rng):
    """Sound that goes on for so long, at −20 dB: music, speech, both, dialog, noise, ambient or none."""
    n = int(seconds * RATE)
    if kind == "silence":
        return np.zeros(n, np.float32)
    if kind == "both":
        return bed_of("music", of, seconds, rng) * 10 ** (-rng.uniform(3, 14) / 20) + bed_of("speech", of, seconds, rng)
    if kind == "dialog":
        return dialog_of(of, seconds, rng).astype(np.float32)
    if kind == "noise":
        bed = band_pass(rng.standard_normal(n).astype(np.float32), 0, rng.choice([400, 2000, 7000]))
        bed = bed * (1 + 0.5 * np.interp(np.arange(n), np.arange(0, n + RATE, RATE), rng.standard_normal(n // RATE + 1 + (n % RATE > 0))))
        return (bed * 0.1 / np.sqrt((bed**2).mean())).astype(np.float32)
    parts, length = [], 0
    while length < n:
        sound = of[kind][rng.integers(len(of[kind]))]
        samples = faster(sound.samples, rng.uniform(0.8, 1.25)) if kind != "speech" else sound.samples
        if kind == "music" and len(samples) > n:
            begin = rng.integers(len(samples) - n)
            samples = samples[begin : begin + n]
        samples = samples * 0.1 / (np.sqrt((samples**2).mean()) + 1e-9)
        parts += [samples] if kind == "music" else [samples, np.zeros(int(rng.uniform(0.05, 1) * RATE))]
        length += sum(map(len, parts[-2:])) if kind != "music" else len(parts[-1])
    return np.concatenate(parts)[:n].astype(np.float32)


def prepared(samples, rng, plain):
    """An effect as a film may have it."""
    if not plain:
        if rng.random() < 0.6:
            samples = faster(samples, rng.uniform(0.75, 1.35))
        if rng.random() < 0.35:
            samples = band_pass(samples, 0, 400 * 15 ** rng.random())
        if rng.random() < 0.15:
            samples = band_pass(samples, rng.uniform(40, 250), 0)
        if rng.random() < 0.25:
            samples = room(np.concatenate([samples[: 2 * RATE], np.zeros(RATE // 2, np.float32)]), rng, 0.15 * 8 ** rng.random(), rng.uniform(0.2, 1.2))
    samples = samples[: 3 * RATE].copy()
    fade = min(len(samples), RATE // 20)
    samples[-fade:] *= np.linspace(1, 0, fade)
    return samples


def mixed(bed, effects, ratios, rng, apart=(0.8, 2.6), plain=False):
    """Adds effects to a bed, whose level is −20 dB in silence, too. The times of their onsets, their levels and their names."""
    out = bed.copy()
    own = np.sqrt((bed**2).mean()) if bed.any() else 0.1
    truth = []
    at = rng.uniform(0.6, apart[1])
    queue = []
    while at < len(bed) / RATE - 0.5:
        if not queue:
            queue = list(rng.permutation(len(effects)))
        sound = effects[queue.pop()]
        samples = prepared(sound.samples, rng, plain)
        onset = onset_of(samples)
        first = samples[onset : onset + RATE // 10]
        ratio = ratios() if callable(ratios) else ratios
        samples = samples * own * 10 ** (ratio / 20) / (np.sqrt((first**2).mean()) + 1e-9)
        begin = int(at * RATE) - onset
        part = samples[max(0, -begin) :][: len(bed) - max(0, begin)]
        out[max(0, begin) : max(0, begin) + len(part)] += part
        truth.append((at, ratio, sound.name))
        at += rng.uniform(*apart)
    return out, truth
