# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by the tests of visuotactile-play: films, cases that run in parallel, and checks of the
# results.
# Expects PLAY (the program), PYTHON and the plugins on GST_PLUGIN_PATH.
set -euo pipefail
: "${PLAY:?the path of visuotactile-play}" "${PYTHON:?the path of a Python with gi}"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
unset DISPLAY WAYLAND_DISPLAY
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
# The first start scans all plugins, which must not be part of a timed case.
"$PLAY" --version >/dev/null

# ---- films of one second ---------------------------------------------------------------------------------------------
# shellcheck disable=SC2034 # for the tests
h264="x264enc speed-preset=ultrafast tune=zerolatency key-int-max=10"
# shellcheck disable=SC2034
vorbis="audiotestsrc num-buffers=40 samplesperbuffer=1102 ! audio/x-raw,rate=44100,channels=1 ! vorbisenc"

# picture WIDTH HEIGHT [FORMAT [FRAMES]]: the beginning of a launch line
picture() {
  echo "videotestsrc pattern=ball num-buffers=${4:-30} ! video/x-raw,format=${3:-I420},width=$1,height=$2,framerate=30/1"
}

# plain COMMAND ...: without this project's plugins, which programs without a sanitizer's runtime
# cannot load
plain() {
  env -u GST_PLUGIN_PATH -u GST_PLUGIN_PATH_1_0 GST_REGISTRY_1_0="${GST_REGISTRY_1_0:-$work/registry}.plain" "$@"
}

# film NAME LAUNCH_LINE: writes NAME by a line without a sink
film() {
  # shellcheck disable=SC2086 # a launch line is many words
  plain timeout 30 gst-launch-1.0 -q $2 ! filesink location="$1" >"$1.log" 2>&1 || { cat "$1.log"; return 1; }
  rm -f "$1.log"
}

# cut NAME FROM PERCENT
cut_film() {
  head -c $(($(stat -c %s "$2") * $3 / 100)) "$2" >"$1"
}

# ---- cases -----------------------------------------------------------------------------------------------------------
cases=0
declare -A running=()

fail() {
  echo "$*"
  exit 1
}

# start NAME COMMAND ...: a case in its own folder, four in parallel
start() {
  local name=$1
  shift
  while [ "$(jobs -rp | wc -l)" -ge 4 ]; do
    wait -n || true
  done
  mkdir "$work/$name"
  (cd "$work/$name" && "$@") >"$work/$name.log" 2>&1 &
  running[$name]=$!
  cases=$((cases + 1))
}

# Ends the test, and fails if any case did.
finish() {
  local name failed=0
  for name in "${!running[@]}"; do
    wait "${running[$name]}" && continue
    failed=$((failed + 1))
    printf -- '---- %s fails:\n' "$name"
    cat "$work/$name.log"
  done
  echo "$cases cases, $failed failed"
  [ "$failed" -eq 0 ] && [ "$cases" -gt 0 ]
}

# play ARGUMENTS ...: sets `status`, writes the files out and err
play() {
  status=0
  timeout 120 "$PLAY" "$@" >out 2>err || status=$?
}

# play_on ARGUMENTS ...: likewise, in the background; sets `pid`
play_on() {
  # Background jobs of a script ignore SIGINT, unlike a program started at a terminal.
  "$PYTHON" -c 'import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])' \
    "$PLAY" "$@" >out 2>err &
  pid=$!
}

# until_true COMPLAINT COMMAND ...: waits until the command succeeds while the program runs, at most
# half a minute
until_true() {
  for _ in $(seq 600); do
    "${@:2}" && return
    kill -0 "$pid" 2>/dev/null || fail "ended by itself: $(cat err)"
    sleep 0.05
  done
  fail "$1: $(cat err)"
}

# await SECONDS: waits for the program's end, which only a program that hangs fails to reach; sets
# `status`
await() {
  local end=$((SECONDS + $1))
  while kill -0 "$pid" 2>/dev/null; do
    if ((SECONDS > end)); then
      kill -KILL "$pid"
      fail "still runs after $1 s: $(cat err)"
    fi
    sleep 0.05
  done
  status=0
  wait "$pid" || status=$?
}

# ---- checks ------------------------------------------------------------------------------------
expect_status() {
  [ "$status" -eq "$1" ] || fail "status $status instead of $1; it said: $(cat err)"
}

expect_line() {
  grep -qE -- "$2" "$1" || fail "no line like '$2' in: $(cat "$1")"
}

# expect_report: the report's lines, in order
expect_report() {
  local labels
  labels=$(grep -oE '^(Film broken|Film|Picture|Played|Frames|Analysis|Commands|Schedule error|Recording|Written) ' out | sed 's/ $//' | paste -sd, -)
  [ "${labels/Film broken,/}" = "Film,Picture,Played,Frames,Analysis,Commands,Schedule error,Written" ] || fail "the report has $labels"
}

# expect_commands FILE [NONE]: the trace is complete and every tactor ends at zero volts; without a
# second argument there are commands
expect_commands() {
  [ "$(head -n 1 "$1")" = issued_ns,due_ns,effect_ns,tactor,volts ] || fail "$1 begins with $(head -n 1 "$1")"
  awk -F, 'NR > 1 { if (NF != 5 || $3 < $2 || $5 < 0 || $5 > 3) { print "bad line " NR ": " $0; exit 1 } last[$4] = $5 }
    END { for (tactor in last) if (last[tactor] != 0) { print "tactor " tactor " ends at " last[tactor] " V"; exit 1 } }' "$1" || fail "$1"
  [ $# -gt 1 ] || [ "$(wc -l <"$1")" -gt 1 ] || fail "$1 holds no command"
}

# expect_strip FILE: a PNG that decodes
expect_strip() {
  [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ] || fail "$1 is no PNG"
  # A copy, for names that a launch line cannot contain.
  cp -- "$1" strip_to_check.png
  plain gst-launch-1.0 -q filesrc location=strip_to_check.png ! pngdec ! fakesink >decoded 2>&1 || fail "$1 does not decode: $(cat decoded)"
}

# expect_recording FILE LEAST MOST [WIDTH HEIGHT STREAMS]: the duration in seconds is within bounds,
# and the rest matches if given
expect_recording() {
  local seconds rest
  read -r seconds rest < <(plain "$PYTHON" "$here/film_info.py" "$1") || fail "$1 is not whole"
  awk -v s="$seconds" -v least="$2" -v most="$3" 'BEGIN { exit !(s >= least && s <= most) }' || fail "$1 lasts $seconds s instead of $2 to $3 s"
  [ $# -lt 4 ] || [ "$rest" = "$4" ] || fail "$1 is $rest instead of $4"
}

# expect_only FOLDER NAME ...: exactly these files, including hidden ones
expect_only() {
  local folder=$1 has
  shift
  has=$(cd -- "$folder" && find . -mindepth 1 -maxdepth 1 -printf '%f\n' | sort | paste -sd' ' -)
  [ "$has" = "$(printf '%s\n' "$@" | sort | paste -sd' ' -)" ] || fail "'$folder' holds $has instead of $*"
}

# expect_all FOLDER LEAST MOST [WIDTH HEIGHT STREAMS]: status 0, a report and all three files, complete
expect_all() {
  expect_status 0
  expect_report
  expect_only "$1" visuotactile.mkv commands.csv strip.png
  expect_recording "$1/visuotactile.mkv" "${@:2}"
  expect_commands "$1/commands.csv" any
  expect_strip "$1/strip.png"
}
