#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Copies of foreign films with a track: what goes in comes out, by ffprobe and by decoded pictures.

Usage: mux_films.py [--all | NAME ...]      (TRACK: tactile-track; without names, those of CHOSEN; --all makes the table of docs/measured/mux.md)
"""
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile

TRACK = os.environ["TRACK"]
SHARED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../shared/data/files")
SECONDS = 2
MOST_INPUTS = 24  # of one ffmpeg
# What films are made of: one ffmpeg makes them all, as its start takes longer than a film.
INPUTS = (f"-f lavfi -i testsrc2=size=160x120:rate=25:duration={SECONDS} -f lavfi -i sine=frequency=440:duration={SECONDS}"
          f" -f lavfi -i sine=frequency=880:duration={SECONDS} -i words.srt -i more.srt -i chapters.txt -i cover.png")
PICTURE, SOUND, OTHER_SOUND, WORDS, COVER = "-map 0", "-map 1", "-map 2", "-map 3 -map 4", "-map 6"
X264 = "-c:v libx264 -preset ultrafast -bf 2 -b_strategy 0 -g 12 -pix_fmt yuv420p"
X265 = "-c:v libx265 -preset ultrafast -pix_fmt yuv420p10le -x265-params log-level=none:keyint=12:bframes=2"
HDR = (":hdr10=1:repeat-headers=1:colorprim=bt2020:transfer=smpte2084:colormatrix=bt2020nc:max-cll=1000,400"
       ":master-display=G(13250,34500)B(7500,3000)R(34000,16000)WP(15635,16450)L(10000000,50)")
ALPHA = "-vf format=yuva420p,geq=lum=X:a=Y -deadline realtime -cpu-used 8"
SUBTITLES = "-metadata:s:s:0 language=ger -metadata:s:s:1 language=eng"

ALPHA_LOST = ["alpha", r"^\d+ pictures are others"]
PCM = ["audio, pcm_s16le", "^audio: 0 of 1"]

# A transport stream has no subtitles of text, titles and chapters; MP4 and it have no attachments and MP4 no styles.
WORDS_LOST = [r"stream 3 \(subtitle", r"stream 4 \(subtitle", "^subtitle: 0 of 2", "title 'My Film'", "^the title is None", "chapter 1", "chapter 2", "^other chapters"]
ATTACHMENT = ["attachment, ttf, 'font.ttf'", "^attachment: 0 of 1"]

# Name, how ffmpeg makes it, and what a copy lacks, by container: a pattern for each line that is told, and with ^ what ffprobe finds.
# None: no copy can be made.
FILMS = {
    "bframes.mkv": (f"{PICTURE} {SOUND} {X264} -c:a aac", {}),
    "edit_list.mp4": (f"{PICTURE} {SOUND} {X264} -c:a aac", {}),
    "offset.mp4": (f"{PICTURE} {SOUND} {X264} -c:a aac -output_ts_offset 1.5", {}),
    "fragments.mp4": (f"{PICTURE} {SOUND} {X264} -c:a aac -movflags frag_keyframe+empty_moov", {}),
    "hdr.mkv": (f"{PICTURE} {X265}{HDR}", {}),
    "hdr.mp4": (f"{PICTURE} {X265}{HDR} -tag:v hvc1", {}),
    "alpha.webm": (f"{PICTURE} {ALPHA} -c:v libvpx-vp9", {"mp4": ALPHA_LOST, "ts": None}),
    # FFmpeg 5.1 moves Opus against the picture, and mkvmerge 74 keeps alpha without the mark that tells of it.
    "alpha_opus.webm": (f"{PICTURE} {SOUND} {ALPHA} -c:v libvpx-vp9 -c:a libopus", {"mkv": ["alpha"], "mp4": ALPHA_LOST, "ts": None}),
    "alpha_vp8.webm": (f"{PICTURE} {SOUND} {ALPHA} -c:v libvpx -auto-alt-ref 0 -c:a libopus", {"mkv": ["alpha"], "mp4": None, "ts": None}),
    "opus.webm": (f"{PICTURE} {SOUND} -c:v libvpx-vp9 -deadline realtime -cpu-used 8 -c:a libopus", {"ts": None}),
    "vp8.webm": (f"{PICTURE} {SOUND} -c:v libvpx -deadline realtime -cpu-used 8 -c:a libvorbis", {"mp4": None, "ts": None}),
    "av1.mkv": (f"{PICTURE} -c:v libaom-av1 -cpu-used 8 -usage realtime -g 12", {"ts": None}),
    "ps.mpg": (f"{PICTURE} {SOUND} -c:v mpeg2video -bf 2 -c:a mp2", {}),
    "mpeg2.ts": (f"{PICTURE} {SOUND} -c:v mpeg2video -bf 2 -flags +ilme+ildct -c:a ac3", {}),
    "h264.avi": (f"{PICTURE} {SOUND} {X264} -c:a libmp3lame", {}),
    "xvid.avi": (f"{PICTURE} {SOUND} -c:v mpeg4 -vtag xvid -bf 2 -c:a pcm_s16le", {"mp4": PCM, "ts": PCM}),
    "mjpeg.avi": (f"{PICTURE} {SOUND} -c:v mjpeg -pix_fmt yuvj420p -c:a pcm_s16le", {"mp4": PCM, "ts": None}),
    "raw.h264": (f"{PICTURE} {X264}", {}),
    "raw.hevc": (f"{PICTURE} {X265}", {}),
    "prores.mov": (f"{PICTURE} {SOUND} -c:v prores_ks -c:a pcm_s16be -timecode 01:00:00:00", {"mkv": ["data, tmcd", "^data: 0 of 1"], "mp4": None, "ts": None}),
    "wrap.ts": (f"{PICTURE} {SOUND} {X264} -c:a aac -output_ts_offset 95441", {}),
    "hours.ts": (f"{PICTURE} {SOUND} {X264} -c:a aac -output_ts_offset 36000", {}),
    "hours.mkv": (f"{PICTURE} {SOUND} {X264} -c:a aac -output_ts_offset 36000", {}),
    "blu_ray.m2ts": (f"{PICTURE} {SOUND} {X264} -c:a ac3 -mpegts_m2ts_mode 1", {}),
    "tracked.ts": ("TRACK", {}),
    "programs.ts": (f"{PICTURE} {SOUND} {PICTURE} {X264} -c:a aac -program st=0:st=1 -program st=2", {}),
    "rotated.mov": ("ROTATE", {"ts": ["display matrix 'rotation=90'", "^video 0: side"]}),
    "many.mkv": (f"{PICTURE} {SOUND} {OTHER_SOUND} {WORDS} {X264} -c:a libvorbis -c:s:0 srt -c:s:1 ass"
                 f" -metadata title=My@Film -metadata artist=Some@One -metadata:s:a:0 title=As@it@was -metadata:s:a:1 language=fre"
                 f" {SUBTITLES} -metadata:s:s:1 title=For@all -disposition:a:0 0 -disposition:a:1 default -disposition:s:0 forced"
                 " -attach font.ttf -metadata:s:t mimetype=application/x-truetype-font -map_chapters 5",
                 {"mp4": ["subtitle, ass, 'For all'\\): its styles$", *ATTACHMENT],
                  "ts": ["audio, vorbis, 'As it was'", r"stream 2 \(audio, vorbis", "^audio: 0 of 2", "artist 'Some One'", *ATTACHMENT, *WORDS_LOST]}),
    "many.mp4": (f"{PICTURE} {SOUND} {OTHER_SOUND} {WORDS} {X264} -c:a aac -c:s mov_text -metadata title=My@Film"
                 f" {SUBTITLES} -map_chapters 5", {"ts": WORDS_LOST}),
    "cover.mp4": (f"{PICTURE} {COVER} {X264} -c:v:1 png -disposition:v:1 attached_pic", {"ts": ["video, png", "^video: 1 of 2"]}),
    "flash.flv": (f"{PICTURE} {SOUND} {X264} -c:a aac -ar 44100", {}),
    "windows.wmv": (f"{PICTURE} {SOUND} -c:v wmv2 -c:a wmav2", {"mp4": None, "ts": None}),
    "theora.ogv": (f"{PICTURE} {SOUND} -c:v libtheora -c:a libvorbis", {"mp4": None, "ts": None}),
    "vfr.mkv": (f"{PICTURE} {X264} -vf setpts=N*N*0.0009/TB -fps_mode vfr", {}),
    "anamorphic.mkv": (f"{PICTURE} {X264} -vf setsar=16/11", {}),
    "uneven.mkv": (f"{PICTURE} {SOUND} {X264} -vf setpts=N*N*0.0009/TB -fps_mode vfr -c:a aac -metadata:s:v stereo_mode=left_right -output_ts_offset 36000",
                   {"ts": ["stereo 3d", "^video 0: side"]}),
}
# FFmpeg 7 has PCM in MP4, the mark of alpha beside Opus and rotation in transport streams, and no stereo mode in MP4.
FFMPEG_7 = {"xvid.avi": {"mp4": []}, "mjpeg.avi": {"mp4": []}, "alpha_opus.webm": {"mkv": []}, "rotated.mov": {"ts": []},
            "uneven.mkv": {"mp4": ["stereo 3d", "^video 0: side"]}}
if int(re.search(r"version \D*(\d+)", subprocess.run(["ffmpeg", "-version"], capture_output=True, text=True, check=True).stdout).group(1)) >= 7:
    FILMS |= {name: (FILMS[name][0], FILMS[name][1] | lost) for name, lost in FFMPEG_7.items()}
# Of shared/data/files, where they are.
for name in ("base.mkv", "bfonly.mkv", "h264.avi", "xvid.avi", "raw.h264", "rot90.mp4", "alpha.webm", "hours.ts", "wrap_s.ts", "reschange.ts", "vfr.mkv"):
    FILMS["shared/" + name] = (None, {})
FILMS["shared/rot90.mp4"] = (None, FILMS["rotated.mov"][1])
FILMS["shared/alpha.webm"] = (None, FILMS["alpha.webm"][1])
FILMS["shared/base.mkv"] = (None, {"ts": ["language 'eng'", "^video 0: language", "title 'Video'", "^video 0: title", "creation_time"]})

# What the suite tries: each way of copying, and each kind of thing that a copy may lose. Others take the same ways: they are tried with --all.
CHOSEN = {"many.mkv": "mkv mp4 ts", "many.mp4": "mkv", "xvid.avi": "mp4", "h264.avi": "mp4", "raw.h264": "mkv", "ps.mpg": "mkv", "edit_list.mp4": "ts",
          "hdr.mkv": "mp4", "alpha.webm": "mp4", "alpha_opus.webm": "mkv ts", "uneven.mkv": "mp4", "wrap.ts": "mkv", "programs.ts": "ts",
          "tracked.ts": "mkv ts", "rotated.mov": "mkv ts", "cover.mp4": "mp4"}

CUES = [(0.0, 0.4, 0), (0.4, 0.8, 75), (0.8, 1.2, 0), (1.2, 1.72, 100), (1.72, 2.0, 0)]


def run(*arguments, status=(0,)):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=300, stdin=subprocess.DEVNULL, check=False)
    if done.returncode not in status:
        raise AssertionError(f"{' '.join(arguments)}: status {done.returncode}: {done.stdout[-500:]}{done.stderr[-1000:]}")
    return done


def ffmpeg(line):
    run("ffmpeg", "-nostdin", "-y", "-v", "error", *[word.replace("@", " ") for word in line.split()])


def make(names):
    """Makes films, and returns their paths: without those of shared/data/files that are not there."""
    lines = {"plain.ts": f"{PICTURE} {SOUND} {X264} -c:a aac", "upright.mov": f"{PICTURE} {SOUND} {X264} -c:a aac"}
    lines |= {name: FILMS[name][0] for name in names if FILMS[name][0] not in (None, "TRACK", "ROTATE")}
    ffmpeg(" ".join([INPUTS, *(f"-map_chapters -1 {line} {name}" for name, line in lines.items())]))
    if "tracked.ts" in names:  # an older one, which is replaced
        run(TRACK, "mux", "plain.ts", "track.vtt", "-o", "tracked.ts")
    if "rotated.mov" in names:
        ffmpeg("-i upright.mov -c copy -metadata:s:v rotate=90 rotated.mov")
    paths = {name: os.path.join(SHARED, os.path.basename(name)) if FILMS[name][0] is None else name for name in names}
    return {name: path for name, path in paths.items() if os.path.exists(path)}


def ffprobe(path, *what):
    return json.loads(run("ffprobe", "-v", "error", "-of", "json", *what, "file:" + path).stdout)


class Film:
    """What is in a file, without its tactile track."""

    def __init__(self, path, frames):
        self.path = path
        self.frames = frames
        whole = ffprobe(path, "-show_streams", "-show_packets", "-show_chapters", "-show_format", "-show_programs")
        self.maps = {int(program["pmt_pid"]) for program in whole["programs"]}
        times = [float(one["pts_time"]) for one in whole["packets"] if one["codec_type"] in ("video", "audio") and "pts_time" in one]
        # Players' 0:00 (docs/design/time.md).
        self.start = 0.0 if "mp4" in whole["format"]["format_name"] or not times else min(times)
        self.tags = {key.lower(): value for key, value in whole["format"].get("tags", {}).items()}
        self.chapters = [(float(one["start_time"]), one.get("tags", {}).get("title")) for one in whole.get("chapters", [])]
        self.streams = {"video": [], "audio": [], "subtitle": [], "data": [], "attachment": []}
        self.tracks = []
        # The names of MP4's chapters are a stream besides.
        for stream in (one for one in whole["streams"] if one["codec_type"] != "data" or one.get("codec_tag_string") != "text"):
            stream["packets"] = [one for one in whole["packets"] if one["stream_index"] == stream["index"]]
            if stream.get("codec_name") == "mov_text":
                stream["packets"] = [one for one in stream["packets"] if int(one["size"]) > 2]
            tags = stream.get("tags", {})
            is_track = (stream["codec_type"] == "subtitle" and tags.get("language") == "zxx") or stream.get("codec_name") == "klv"
            (self.tracks if is_track else self.streams[stream["codec_type"]]).append(stream)

    def times(self, kind, index):
        return [float(one["pts_time"]) if "pts_time" in one else None for one in self.streams[kind][index]["packets"]]


def pictures(paths):
    """The times and sums of each film's decoded pictures, by path: by one ffmpeg, as its start takes longer, or by one each where it fails."""
    inputs, outputs = [], []
    sums = {path: f"{path.replace('/', '_')}.md5" for path in paths}
    for index, path in enumerate(paths):
        inputs += ["-noautorotate", "-threads", "1", *decoder(path), "-i", "file:" + path]
        outputs += ["-map", f"{index}:v:0", "-fps_mode", "passthrough", "-enc_time_base", "1/90000", "-f", "framemd5", sums[path]]
    if run("ffmpeg", "-nostdin", "-y", "-v", "quiet", "-copyts", *inputs, *outputs, status=(0, 1)).returncode and len(paths) > 1:
        return {path: frames for one in paths for path, frames in pictures([one]).items()}
    found = {}
    for path in paths:
        with open(sums[path], encoding="utf-8") as lines:
            frames = [line.split(",") for line in lines if not line.startswith("#")]
        found[path] = [(int(one[2]) / 90000, one[5].strip()) for one in frames]
        assert found[path], f"{path} has no pictures"
    return found


def decoder(path):
    """What decodes alpha, too."""
    return next((["-c:v", name] for sign, name in (("alpha_vp8", "libvpx"), ("alpha", "libvpx-vp9")) if sign in path), [])


def facts(stream):
    """What has to be kept of a stream."""
    tags = {key.lower(): value for key, value in stream.get("tags", {}).items()}
    title = tags.get("title") or tags.get("handler_name", "")
    side = {one["side_data_type"]: round(one["rotation"]) if "rotation" in one else one.get("type", True) for one in stream.get("side_data_list", [])}
    side.pop("CPB properties", None)
    return {
        "codec": stream.get("codec_name", "").replace("mp2", "mp3") if stream["codec_type"] != "subtitle" else "text",
        "size": (stream.get("width"), stream.get("height")) if stream["codec_type"] == "video" else None,
        "pixel": stream.get("sample_aspect_ratio") if stream.get("sample_aspect_ratio") not in ("1:1", "0:1") else None,
        "colors": [stream.get(f"color_{name}") for name in ("space", "transfer", "primaries")],
        "flags": {key for key, value in stream["disposition"].items() if value and key != "default"},
        "language": tags.get("language") if tags.get("language") != "und" else None,
        "title": "" if title.endswith("Handler") else title,
        "alpha": tags.get("alpha_mode"),
        "side": side,
    }


def near(first, second, tolerance=0.0021):
    return first is None or (second is not None and abs(first - second) <= tolerance)


def differences(film, copy):
    """Lines of what is other in a copy."""
    found = []
    shift = 0.0
    for kind in ("audio", "video"):
        if film.streams[kind] and copy.streams[kind]:
            pairs = zip(film.times(kind, 0), copy.times(kind, 0))
            if kind == "video" and not any(film.times(kind, 0)):
                shift = copy.start
            shift = next((after - before for before, after in pairs if before is not None and after is not None), shift)
    for kind, streams in film.streams.items():
        others = copy.streams[kind]
        if len(streams) != len(others):
            found.append(f"{kind}: {len(others)} of {len(streams)} streams")
            continue
        for index, (one, other) in enumerate(zip(streams, others)):
            name = f"{kind} {index}"
            sizes = [sum(int(packet["size"]) for packet in stream["packets"]) for stream in (one, other)]
            if kind == "attachment":
                if one["extradata_size"] != other["extradata_size"] or one["tags"]["filename"] != other["tags"]["filename"]:
                    found.append(f"{name}: another file")
                continue
            if one.get("codec_name", "").startswith("pcm") and len(one["packets"]) != len(other["packets"]) and sizes[0] == sizes[1]:
                continue
            if len(one["packets"]) != len(other["packets"]):
                found.append(f"{name}: {len(other['packets'])} of {len(one['packets'])} packets")
            before, after = film.times(kind, index), copy.times(kind, index)
            off = [(a, b) for a, b in zip(before, after) if a is not None and not near(a + shift, b)]
            if off:
                found.append(f"{name}: {len(off)} packets have other times, {off[0]}")
            if kind == "video" and None in before and len(set(after)) != len(after):
                found.append(f"{name}: times are not all different")
            had, has = facts(one), facts(other)
            found += [f"{name}: {key} {had[key]} is {has[key]}" for key in had if had[key] != has[key] and not (key == "side" and had[key].items() <= has[key].items()) and had[key] not in (None, "", "unknown", [None, None, None])]
    if [md5 for _, md5 in film.frames] != [md5 for _, md5 in copy.frames]:
        found.append(f"{len(copy.frames)} pictures are others than the film's {len(film.frames)}")
    elif None not in film.times("video", 0):
        begin = copy.frames[0][0] - film.frames[0][0]
        found += [f"a picture at {b[0]} instead of {a[0]}" for a, b in zip(film.frames, copy.frames) if not near(a[0] + begin, b[0])][:1]
    if film.tags.get("title") != copy.tags.get("title"):
        found.append(f"the title is {copy.tags.get('title')}")
    # Programs leave chapters where they are when they move packets by a codec's delay.
    if len(film.chapters) != len(copy.chapters) or any(one[1] != other[1] or not near(one[0] + shift, other[0], 0.05) for one, other in zip(film.chapters, copy.chapters)):
        found.append("other chapters")
    if len(copy.tracks) != 1:
        return found + [f"{len(copy.tracks)} tracks"]
    times = [float(one.get("pts_time", -1)) for one in copy.tracks[0]["packets"]]
    if len(times) != len(CUES) or not all(near(max(film.start + shift, 0) + cue[0], time) for cue, time in zip(CUES, times)):
        found.append(f"the track's times are {times}, the film begins at {film.start + shift}")
    if copy.tracks[0]["disposition"]["default"] or copy.tracks[0]["disposition"]["forced"]:
        found.append("players choose the track")
    return found


class Copies:
    """Of a film: what was told of each, and what is wrong with it, by container."""

    def __init__(self, name, path, containers):
        self.name, self.path = name, path
        self.expected = {container: FILMS[name][1].get(container, []) for container in containers}
        self.outs = {container: f"{name.replace('/', '_')}.{container}" for container in containers}
        self.told, self.wrong = {}, {}

    def make(self):
        for container, out in self.outs.items():
            done = run(TRACK, "mux", self.path, "track.vtt", "-o", out, status=(0, 1, 3))
            self.told[container] = [line.removeprefix("tactile-track: ").removeprefix(f"not in '{out}': ") for line in done.stderr.splitlines()]
            self.wrong[container] = judge_words(done, self.expected[container], os.path.exists(out))
        self.outs = {container: out for container, out in self.outs.items() if os.path.exists(out)}
        return self

    def paths(self):
        return [self.path, *self.outs.values()] if self.outs else []

    def compare(self, frames):
        if self.outs:
            film = Film(self.path, frames[self.path])
        for container, out in self.outs.items():
            copy = Film(out, frames[out])
            # What was told may differ.
            self.wrong[container] += [line for line in differences(film, copy) if not any(re.search(pattern, line) for pattern in self.expected[container])]
            if container == "ts" and ".ts" in self.name and other_packets(film) != other_packets(copy):
                self.wrong[container].append("other packets of the transport stream")
            os.remove(out)
        return self

    def cell(self, container):
        """Of a table."""
        if self.wrong[container]:
            return "**" + "; ".join(self.wrong[container]) + "**"
        told = [re.sub(r"^no copy of '.*' can be made: ", "", line).replace("|", "/") for line in self.told[container]]
        if self.expected[container] is None:
            return "no copy: " + "; ".join(told)
        return "without " + "; ".join(told) if told else "whole"


def judge_words(done, expected, is_there):
    """What is wrong with what a program told of a copy."""
    told = done.stderr.splitlines()
    if expected is None:
        return [] if done.returncode == 1 and len(told) == 1 and not is_there else [f"expected an error, got {done.returncode} {told}"]
    if done.returncode == 1:
        return told
    wrong = [] if done.returncode == (3 if expected else 0) else [f"status {done.returncode}"]
    for pattern in expected:
        if not pattern.startswith("^") and not any(re.search(pattern, line) for line in told):
            wrong.append(f"not told: {pattern}")
    return wrong + [f"told: {line}" for line in told if not any(re.search(pattern, line) for pattern in expected)]


def other_packets(film):
    """The packets of a transport stream, without the program map and the track."""
    without = film.maps | {int(stream["id"], 16) for stream in film.tracks if stream.get("codec_name") == "klv"}
    with open(film.path, "rb") as file:
        data = file.read()
    packets = [data[at:at + 188] for at in range(0, len(data), 188)]
    return [packet for packet in packets if ((packet[1] & 0x1F) << 8 | packet[2]) not in without]


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("track.vtt", "w", encoding="utf-8") as track:
            track.write("WEBVTT\n\nNOTE tactile grid=2x2\n")
            for begin, end, level in CUES:
                track.write(f"\n00:00:{begin:06.3f} --> 00:00:{end:06.3f}\n{level} 0\n0 {level}\n")
        for name in ("words", "more"):
            with open(f"{name}.srt", "w", encoding="utf-8") as words:
                words.write("1\n00:00:00,200 --> 00:00:00,900\nWho is there?\n\n2\n00:00:01,100 --> 00:00:01,600\nA & B < C\n")
        with open("font.ttf", "wb") as font:
            font.write(bytes(range(256)) * 8)
        with open("chapters.txt", "w", encoding="utf-8") as chapters:
            chapters.write(";FFMETADATA1\n[CHAPTER]\nTIMEBASE=1/1000\nSTART=0\nEND=1000\ntitle=To begin with\n[CHAPTER]\nTIMEBASE=1/1000\nSTART=1000\nEND=2000\ntitle=In the end\n")
        ffmpeg("-f lavfi -i color=red:size=32x32:duration=1:rate=1 -frames:v 1 cover.png")
        every = "mkv mp4 ts"
        shows_all = sys.argv[1:] == ["--all"]
        chosen = {name: every for name in (FILMS if shows_all else sys.argv[1:])} or CHOSEN
        paths = make(chosen)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            films = list(pool.map(Copies.make, [Copies(name, path, chosen[name].split()) for name, path in paths.items()]))
            every_path = [path for film in films for path in film.paths()]
            frames = {}
            for found in pool.map(pictures, [every_path[at:at + MOST_INPUTS] for at in range(0, len(every_path), MOST_INPUTS)]):
                frames |= found
            films = list(pool.map(lambda film: film.compare(frames), films))
        if shows_all:
            print("| film | in Matroska | in MP4 | in a transport stream |\n|---|---|---|---|")
        for film in films:
            if shows_all:
                print(f"| {film.name} | {' | '.join(map(film.cell, every.split()))} |")
            else:
                print(*(f"{film.name} -> {container}: {'; '.join(lines) or 'as it should be'}" for container, lines in film.wrong.items()), sep="\n")
        failed = any(lines for film in films for lines in film.wrong.values())
        left = [name for name in os.listdir(".") if name.startswith(".")]
        assert not left, left
    sys.exit(failed)


if __name__ == "__main__":
    main()
