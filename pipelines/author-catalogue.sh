#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes the tracks of all films in a folder and prints a table of them. A film that fails is tried once more. Tracks that exist are
# kept, so the same command resumes an interrupted run.
#
# Usage: pipelines/author-catalogue.sh [--jobs N] FILMS TRACKS [-- OPTION...]    by GNU parallel on this machine, a film a job
#        pipelines/author-catalogue.sh --slurm FILMS TRACKS [-- OPTION...]       as a job array of Slurm; TRACKS on a shared disk
#        pipelines/author-catalogue.sh --table FILMS TRACKS                      the table only
#   --resume      the films of the last run, TRACKS/.films, without those that came later
#   --limit TIME  kills the analysis of a film after that time, such as 90m (default: 12h)
#   OPTION        of tactile-track author, such as --rows=4
# The status is 0 if every film has its track.
set -euo pipefail

mode=parallel
jobs=$(nproc)
limit=12h
resumes=
list=
while [[ ${1:-} == --* ]]; do
  case $1 in
    --jobs) jobs=${2:-}; shift ;;
    --limit) limit=${2:-}; shift ;;
    --list) list=${2:-}; shift ;; # of a task
    --resume) resumes=yes ;;
    --slurm | --table | --task) mode=${1#--} ;;
    --help) sed -n '3,13s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "author-catalogue.sh: unknown option '$1'; see --help" >&2; exit 2 ;;
  esac
  shift
done
if ! [[ $limit =~ ^[0-9]+[smhd]?$ && $jobs =~ ^[0-9]+$ ]]; then
  echo "author-catalogue.sh: expected --limit such as 90m and a number of --jobs, not '$limit' and '$jobs'" >&2
  exit 2
fi
if [ $# -lt 2 ] || [ ! -d "$1" ]; then
  echo "author-catalogue.sh: expected a folder of films and one for tracks; see --help" >&2
  exit 2
fi
films=$(realpath -- "$1")
mkdir -p -- "$2"
tracks=$(realpath -- "$2")
shift 2
[ "${1:-}" != -- ] || shift

if ! command -v tactile-track >/dev/null; then
  # shellcheck source=../tools/build.sh
  . "$(dirname "$0")/../tools/build.sh"
  # shellcheck disable=SC2034 # for build_and_use
  targets=tools/tactile-track
  build_and_use
  PATH=$root/build/tools:$PATH
fi

# The films of a run: paths below their folder, NUL-terminated, in a fixed order. A film that comes later changes no run.
list=${list:-$tracks/.films}
freeze() {
  # A folder that cannot be read is named by find, and left out.
  (cd -- "$films" && { find . -type f -regextype posix-extended -iregex '.*\.(mkv|mp4|m4v|mov|webm|avi|ts|mpg|ogv)' -printf '%P\0' || true; } | sort -z) >"$list.new"
  mv -- "$list.new" "$list"
}
if [ "$mode" != task ] && [ -z "$resumes" ] && { [ "$mode" != table ] || [ ! -e "$list" ]; }; then
  freeze
elif [ ! -e "$list" ]; then
  echo "author-catalogue.sh: no run to resume in '$tracks'; expected its list .films" >&2
  exit 2
fi

# track FILM: path of its track: the same relative folder and the full name, since names may differ in the extension only
track() {
  printf '%s.vtt\n' "$tracks/$1"
}

# one FILM OPTION...: tries twice; .reasons/FILM.txt has the reason of the last failure
one() {
  local out reason status try
  out=$(track "$1")
  reason=$tracks/.reasons/$1.txt
  mkdir -p -- "$(dirname -- "$out")" "$(dirname -- "$reason")"
  for ((try = 0; try < 2; try++)); do
    status=0
    timeout --foreground --kill-after=10 "$limit" tactile-track author --jobs=1 "$films/$1" -o "$out" "${@:2}" 2>"$reason" || status=$?
    case $status in
      124) echo "stopped after $limit" >>"$reason" ;;
      137) echo "killed: after $limit, or for want of memory" >>"$reason" ;;
    esac
    cat -- "$reason" >&2
    case $status in
      0) rm -- "$reason"; break ;;
      130 | 143) break ;;
    esac
  done
  return "$status"
}

table() {
  local film out information reason missing=0
  printf '%-40s %10s %6s\n' film "length (s)" "felt"
  while IFS= read -r -d '' film; do
    out=$(track "$film")
    reason=$(tail -n 1 -- "$tracks/.reasons/$film.txt" 2>/dev/null) || true
    reason=${reason##*"/$film: "}
    if [ -f "$out" ] && information=$(tactile-track info "$out" 2>/dev/null); then
      awk -v film="$film" -v older="${reason:+  (older: $reason)}" '/^Length/ { length_s = $2 } /^Felt/ { felt = substr($4, 2) " %" }
        END { printf "%-40s %10s %6s%s\n", film, length_s, felt, older }' <<<"$information"
    else
      printf '%-40s %10s: %s\n' "$film" "no track" "${reason:-not tried}"
      missing=$((missing + 1))
    fi
  done <"$list"
  echo "$missing without a track"
  [ "$missing" -eq 0 ]
}

mapfile -d '' -t all <"$list"
if [ ${#all[@]} -eq 0 ]; then
  echo "author-catalogue.sh: no films in '$films'" >&2
  exit 1
fi

case $mode in
  parallel)
    export -f one track
    export films tracks limit
    # A film that fails does not stop the others; Ctrl-C starts no further ones.
    parallel --null --jobs "$jobs" --line-buffer one {} "$@" <"$list" || true
    table
    ;;
  slurm)
    # An array is limited: if there are more films than tasks, each task has several.
    most=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')
    count=$((${#all[@]} < ${most:-1001} ? ${#all[@]} : ${most:-1001}))
    # Another run may follow before this one has ended.
    frozen=$(mktemp "$tracks/.films-XXXXXX")
    cp -- "$list" "$frozen"
    # With --wait, sbatch returns after the last film, and fails if any film failed.
    sbatch --wait --quiet --job-name=author-catalogue --array="0-$((count - 1))" --cpus-per-task=1 --output="$tracks/slurm-%A-%a.log" \
      --wrap "$(printf '%q ' "$(realpath -- "$0")" --task --list "$frozen" --limit "$limit" "$films" "$tracks" -- "$@")" && rm -- "$frozen"
    table
    ;;
  task)
    status=0
    for ((i = SLURM_ARRAY_TASK_ID; i < ${#all[@]}; i += SLURM_ARRAY_TASK_COUNT)); do
      one "${all[i]}" "$@" || status=$?
    done
    exit "$status"
    ;;
  table) table ;;
esac
