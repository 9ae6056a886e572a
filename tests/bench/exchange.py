#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Has the readers and writers of others read what tactile-track writes, and tactile-track read what they write:
docs/measured/exchange.md. By hand: it fetches them (git, npm) into an empty folder.

Usage: tests/bench/exchange.py TACTILE_TRACK [PART ...]   (node, python, rust, mpeg; default: all)
Needs git and npm; rust: apt install cargo librust-serde-json-dev librust-serde-derive-dev librust-itertools-num-dev;
mpeg: g++; python: python3-numpy. Prints a line for each reader; the first that differs ends it."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import wave

TRACK = str(pathlib.Path(sys.argv[1]).resolve())
PARTS = sys.argv[2:] or ["node", "python", "rust", "mpeg"]
work = pathlib.Path(tempfile.mkdtemp(prefix="exchange-"))
# Time in ms, levels of 2 x 3 cells, Hz. The last one is the end.
STEPS = [(0, [0] * 6, 0), (100, [0.5, 0, 0, 0, 0, 0.25], 120), (350, [0, 0.75, 0, 0, 0, 0], 250), (600, [0] * 6, 0),
         (1000, [1, 0.1, 0.2, 0.3, 0.4, 0.5], 80), (1330, [0] * 6, 0), (2000, [0] * 6, 0)]
FELT = [(begin, end, levels, hz) for (begin, levels, hz), (end, _, _) in zip(STEPS, STEPS[1:]) if any(levels)]
FORMATS = ["vtt", "hjif", "sem.xml", "haptic", "ahap", "funscript"]


def run(*command, folder=work, **options):
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, (command, done.stdout[-3000:], done.stderr[-3000:])
    return done.stdout


def fetch(repository, commit, *paths):
    folder = work / repository.split("/")[1]
    run("git", "clone", "--quiet", "--filter=blob:none", "--no-checkout", f"https://github.com/{repository}", folder)
    run("git", "checkout", "--quiet", commit, "--", *paths, folder=folder)
    return folder


def say(reader, what):
    print(f"| {reader} | {what} |", flush=True)


def is_near(values, expected, tolerance=0.0051):
    assert len(values) == len(expected) and all(abs(a - b) <= tolerance for a, b in zip(values, expected)), (values, expected)


def between(points, at):
    """The value of points (time, value) that are joined by straight lines."""
    for (t0, v0), (t1, v1) in zip(points, points[1:]):
        if t0 <= at < t1:
            return v0 + (v1 - v0) * (at - t0) / (t1 - t0)
    return points[-1][1]


def middles():
    return [(begin + end) / 2 for (begin, _, _), (end, _, _) in zip(STEPS, STEPS[1:])]


def strongest():
    return [max(levels) for _, levels, _ in STEPS[:-1]]


def read_back(path, at):
    """Level and Hz of the first cell at these times in ms, by tactile-track."""
    out = work / "back.csv"
    run(TRACK, "convert", "--force", path, "-o", out)
    lines = out.read_text(encoding="utf-8").splitlines()
    names = lines[1].split(",")
    rows = [dict(zip(names, map(float, line.split(",")))) for line in lines[2:]]
    found = [[row for row in rows if row["time_ms"] <= time][-1] for time in at]
    return [row["t0"] for row in found], [row.get("hz", 0) for row in found]


def write_files():
    names = "time_ms," + ",".join(f"t{i}" for i in range(6)) + ",hz"
    lines = [f"{time},{','.join(map(str, levels))},{hz}" for time, levels, hz in STEPS]
    (work / "t.csv").write_text("\n".join(["# tactile grid=2x3 rate=5", names, *lines]) + "\n", encoding="utf-8")
    for ending in FORMATS:
        run(TRACK, "convert", "t.csv", "-o", f"t.{ending}")
    # A playlist as ffmpeg's, with a track beside it.
    run("ffmpeg", "-v", "error", "-f", "lavfi", "-i", "testsrc=size=64x64:rate=25:duration=2", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-b:v", "100k", "-g",
        "25", "-f", "hls", "-hls_time", "1", "-hls_playlist_type", "vod", "-master_pl_name", "master.m3u8", "video.m3u8")
    run(TRACK, "hls", "master.m3u8", "t.csv", "--url=https://example.org")


def cues_of(cues):
    """Of WebVTT: begin and end in s, text."""
    felt = [cue for cue in cues if any(float(word) for word in cue[2].split() if word != "Hz")]  # silent ones mark begin and end
    for (begin, end, text), (b, e, levels, hz) in zip(felt, FELT, strict=True):
        is_near([begin, end], [b / 1000, e / 1000], 0.0011)
        words = text.split()
        is_near([float(word) / 100 for word in words[:-2]], levels)
        assert words[-2:] == [str(hz), "Hz"], text


NODE = r"""
const fs = require('fs'), text = name => fs.readFileSync(name, 'utf8'), out = {};
const vtt = text('t.vtt'), version = name => JSON.parse(text('node_modules/' + name + '/package.json')).version;
{ const { WebVTTParser } = require('webvtt-parser'); const t = new WebVTTParser().parse(vtt, 'subtitles');
  out['webvtt-parser'] = { errors: t.errors, cues: t.cues.map(c => [c.startTime, c.endTime, c.text]) }; }
{ const t = require('node-webvtt').parse(vtt, { meta: true, strict: true });
  out['node-webvtt'] = { errors: t.valid ? [] : t.errors, cues: t.cues.map(c => [c.start, c.end, c.text]) };
  out.segments = [0, 1].map(n => require('node-webvtt').parse(text(`tactile/${n}.vtt`).replace(/^X-.*\n/m, ''), { strict: true }).cues.length); }
{ const errors = [], cues = [], { WebVTT } = require('vtt.js'); global.window = { VTTCue: function (b, e, t) { this.text = t; } };
  global.VTTCue = global.window.VTTCue; const p = new WebVTT.Parser(global.window, WebVTT.StringDecoder());
  p.oncue = c => cues.push([c.startTime, c.endTime, c.text]); p.onparsingerror = e => errors.push(e.message); p.parse(vtt); p.flush();
  out['vtt.js'] = { errors, cues }; }
{ const f = require('funscript-utils'), c = f.FunConverter || f, s = c.getFunscriptFromString(text('t.funscript')), tweak = f.FunTweaker || f;
  out['funscript-utils'] = s.actions.map(a => [a.at, a.pos]);
  fs.writeFileSync('shifted.funscript', JSON.stringify(tweak.getOffsetScript(s, 500))); }
{ const { Parser } = require('m3u8-parser');
  for (const name of ['master.m3u8', 'tactile/index.m3u8']) { const p = new Parser(); p.push(text(name)); p.end(); out['m3u8-parser ' + name] = p.manifest; } }
{ const HLS = require('hls-parser'); HLS.setOptions({ strictMode: true });
  const m = HLS.parse(text('master.m3u8')), i = HLS.parse(text('tactile/index.m3u8'));
  out['hls-parser'] = { subtitles: m.variants[0].subtitles.map(s => s.name + ' ' + s.uri), data: m.sessionDataList.map(d => d.id + ' ' + d.value),
    durations: i.segments.map(s => s.duration), ended: i.endlist, target: i.targetDuration }; }
out.versions = Object.fromEntries(['webvtt-parser', 'node-webvtt', 'vtt.js', 'funscript-utils', 'm3u8-parser', 'hls-parser'].map(n => [n, version(n)]));
console.log(JSON.stringify(out));
"""


def node():
    run("npm", "install", "--no-audit", "--no-fund", "webvtt-parser", "node-webvtt", "vtt.js", "funscript-utils", "m3u8-parser", "hls-parser")
    (work / "read.cjs").write_text(NODE, encoding="utf-8")
    out = json.loads(run("node", "read.cjs"))
    named = {name: f"{name} {version} (npm)" for name, version in out["versions"].items()}
    for reader in "webvtt-parser", "node-webvtt", "vtt.js":
        assert out[reader]["errors"] == [], (reader, out[reader])
        cues_of(out[reader]["cues"])
        say(named[reader], "WebVTT: no errors; times, levels and Hz of all cues")
    points = out["funscript-utils"]
    is_near([between(points, at) / 100 for at in middles()], strongest())
    say(named["funscript-utils"], "funscript: the strongest cell's level at all times")
    is_near(read_back(work / "shifted.funscript", [at + 500 for at in middles()])[0], strongest())
    say(named["funscript-utils"], "wrote `getOffsetScript`'s funscript, which was read with the same levels, 0.5 s later")
    group = out["m3u8-parser master.m3u8"]["mediaGroups"]["SUBTITLES"]["tactile"]["Tactile"]
    index = out["m3u8-parser tactile/index.m3u8"]
    assert group["uri"] == "tactile/index.m3u8" and index["endList"] and len(index["segments"]) == 2, (group, index)
    say(named["m3u8-parser"], "HLS: the rendition, its segments and end")
    hls = out["hls-parser"]
    assert hls["subtitles"] == ["Tactile tactile/index.m3u8"] and hls["ended"] and max(hls["durations"]) <= hls["target"], hls
    assert hls["data"] == ["com.apple.hls.haptics.url https://example.org/tactile.ahap"], hls
    say(named["hls-parser"], "HLS, strictly: the rendition, its segments and end, the session data")
    assert sum(out["segments"]) >= len(FELT), out["segments"]


def python():
    folder = fetch("edger477/funscript-tools", "7cecc013", "funscript", "examples")
    code = """
import sys; sys.path.insert(0, 'funscript-tools')
from funscript import Funscript
read = Funscript.from_file('t.funscript'); read.save_to_path('saved.funscript'); print([read.x.tolist(), read.y.tolist()])"""
    x, y = json.loads(run("/usr/bin/python3", "-c", code))
    is_near([between(list(zip(x, y)), at / 1000) for at in middles()], strongest())
    say("edger477/funscript-tools 7cecc013", "funscript: the strongest cell's level at all times")
    is_near(read_back(work / "saved.funscript", middles())[0], strongest(), 0.011)  # it cuts levels to whole percent
    is_near(read_back(folder / "examples/sample.funscript", [510, 990, 1010])[0], [0.98, 0.07, 0.07], 0.03)
    say("edger477/funscript-tools 7cecc013", "its saved file and its example were read")
    fetch("michael-mueller-git/Python-Funscript-Editor", "2a3c39f8", "funscript_editor")
    code = """
import sys, types; sys.modules['cv2'] = types.ModuleType('cv2'); sys.path.insert(0, 'Python-Funscript-Editor/funscript_editor/data')
from funscript import Funscript
script = Funscript(25, inverted=True)
for at, pos in [(0, 100), (500, 100), (501, 40), (1000, 40)]: script.add_action(pos, at, True)
script.save('inverted.funscript', False)"""
    run("/usr/bin/python3", "-c", code)
    is_near(read_back(work / "inverted.funscript", [250, 750])[0], [0, 0.6])
    say("Python-Funscript-Editor 2a3c39f8", "its inverted file was read inverted")


def rust():
    folder = fetch("Lofelt/NiceVibrations", "5e586638", "core/datamodel", "core/utils")
    (folder / "Cargo.toml").write_text('[workspace]\nmembers = ["reader"]\nexclude = ["core"]\n', encoding="utf-8")
    for library in "datamodel", "utils":  # which need criterion, for measurements, and Android's jni
        manifest = folder / "core" / library / "Cargo.toml"
        text = manifest.read_text(encoding="utf-8")
        manifest.write_text(text.split("[dev-dependencies]")[0].split("[target")[0], encoding="utf-8")
        shutil.rmtree(folder / "core" / library / "benches", ignore_errors=True)
    (folder / "reader/src").mkdir(parents=True)
    (folder / "reader/Cargo.toml").write_text('[package]\nname = "reader"\nversion = "0.0.1"\nedition = "2018"\n[dependencies]\n'
                                              'datamodel = {path = "../core/datamodel"}\nserde_json = "1"\n', encoding="utf-8")
    (folder / "reader/src/main.rs").write_text("""
fn main() {
    let text = |name: &str| std::fs::read_to_string(std::env::args().nth(1).unwrap() + "/" + name).unwrap();
    let (_, data) = datamodel::latest_from_json(&text("t.haptic")).unwrap();
    let made = datamodel::ios::v1::Ahap::to_string_pretty(&datamodel::ios::v1::Ahap::from(data)).unwrap();
    std::fs::write(std::env::args().nth(1).unwrap() + "/theirs.ahap", made).unwrap();
    let ahap: datamodel::ios::v1::Ahap = serde_json::from_str(&text("t.ahap")).unwrap();
    println!("{}", datamodel::ios::v1::Ahap::to_string(&ahap).unwrap());
}
""", encoding="utf-8")
    (work / "cargo").mkdir()
    (work / "cargo/config.toml").write_text('[source.crates-io]\nreplace-with = "debian"\n[source.debian]\ndirectory = "/usr/share/cargo/registry"\n',
                                            encoding="utf-8")
    said = run("cargo", "run", "--quiet", "--offline", "-p", "reader", work, folder=folder, env=os.environ | {"CARGO_HOME": str(work / "cargo")})
    events = [each["Event"] for each in json.loads(said)["Pattern"] if "Event" in each]
    is_near([event["Time"] for event in events], [begin / 1000 for begin, _, _, _ in FELT], 0.001)
    say("Lofelt/NiceVibrations 5e586638, datamodel (Rust)", "AHAP: all events")
    levels, hz = read_back(work / "theirs.ahap", middles())
    # It writes the roots of amplitudes and of frequencies from 0 to 1.
    is_near([level**2 for level in levels], strongest(), 0.02)
    is_near([65 + ((value - 65) / 235)**2 * 235 for value, level in zip(hz, levels) if level > 0.01], [hz for _, _, _, hz in FELT], 3)
    say("Lofelt/NiceVibrations 5e586638, datamodel (Rust)",
        "`.haptic`: valid; the AHAP that it made of it was read with the roots of levels and frequencies, as it writes them")


MPEG = r"""
#include <Encoder/include/AhapEncoder.h>
#include <IOHaptics/include/IOJson.h>
#include <Synthesizer/include/Helper.h>
#include <Types/include/Haptics.h>
#include <string>
using namespace haptics;
int main(int, char **argv)
{
  const std::string folder = std::string(argv[1]) + "/";
  types::Haptics film;
  if (!io::IOJson::loadFile(folder + "t.hjif", film) || !io::IOJson::semanticConformanceCheckExperience(film)) return 1;
  film.linearize();
  if (!synthesizer::Helper::playFile(film, synthesizer::Helper::getTimeLength(film), 8000, 0, *new std::string(folder + "t.wav"))) return 2;
  types::Haptics of_ahap("2023", "2026-11-27", "of AHAP");
  of_ahap.setTimescale(1000);
  types::Perception perception(0, 0, "", types::PerceptionModality::Vibrotactile);
  std::string ahap = folder + "t.ahap";
  if (encoder::AhapEncoder::encode(ahap, perception, 1000) != 0) return 3;
  of_ahap.addPerception(perception);
  io::IOJson::writeFile(of_ahap, folder + "of_ahap.hjif");
}
"""


def mpeg():
    folder = fetch("MPEGGroup/HapticReferenceSoftware", "2de9ff19", "source")
    fetch("Tencent/rapidjson", "HEAD", "include")
    fetch("berndporr/iir1", "HEAD", ".")
    fetch("mackron/dr_libs", "HEAD", ".")
    (work / "mpeg.cpp").write_text(MPEG, encoding="utf-8")
    sources = [work / "mpeg.cpp", folder / "source/Synthesizer/src/Helper.cpp", folder / "source/Encoder/src/AhapEncoder.cpp"]
    for part in "IOHaptics", "Types", "Tools", "Spiht", "WaveletDecoder", "FilterBank":
        sources += sorted((folder / "source" / part / "src").glob("*.cpp"))
    # The JSON schema is not public: without it, the software checks the members that it reads, and their values.
    options = ["-std=c++17", "-O1", "-w", '-DJSON_SCHEMA_PATH="none"', f"-I{folder / 'source'}",
               *(f"-I{work / name}" for name in ("rapidjson/include", "iir1", "dr_libs"))]
    run("make", "-f", "-", "-j2", input="all: " + " ".join(f"{i}.o" for i in range(len(sources))) + "\n\tg++ $^ iir1/iir/*.cpp -Iiir1 -o mpeg\n"
        + "".join(f"{i}.o:\n\tg++ {' '.join(o.replace(chr(34), chr(92) + chr(34)) for o in options)} -c {s} -o $@\n" for i, s in enumerate(sources)))
    run("./mpeg", work)
    with wave.open(str(work / "t.wav")) as file:
        channels, rate = file.getnchannels(), file.getframerate()
        samples = [int.from_bytes(file.readframes(1)[:2], "little", signed=True) / 32768 for _ in range(file.getnframes())]
    assert channels == 6, channels
    for begin, end, levels, hz in FELT:
        part = samples[begin * rate // 1000 + 40:end * rate // 1000 - 40]
        crossings = sum(a < 0 <= b for a, b in zip(part, part[1:])) / (len(part) / rate)
        assert abs(max(part, default=0) - levels[0]) < 0.02 and (levels[0] == 0 or abs(crossings - hz) < 8), (begin, max(part), crossings, hz)
    say("MPEGGroup/HapticReferenceSoftware 2de9ff19", "HJIF: valid but for the schema; played with the levels and Hz of the first cell")
    levels, hz = read_back(work / "of_ahap.hjif", middles())
    is_near(levels, [0.6138 * level for level in strongest()], 0.02)  # ACTUAL_AMPLITUDE_MIN_C: of a telephone
    is_near([value for value, level in zip(hz, levels) if level > 0], [hz for _, _, _, hz in FELT], 3)
    say("MPEGGroup/HapticReferenceSoftware 2de9ff19",
        "AHAP: the HJIF that it made of it was read with 0.6138 of the levels, as it writes them, and the same Hz")


print("| reader and writer | read, or written and read here |\n|---|---|")
write_files()
for part_name in PARTS:
    {"node": node, "python": python, "rust": rust, "mpeg": mpeg}[part_name]()
shutil.rmtree(work)
