#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes the tracks of all films in a folder, one job per film, and prints a table of them. Existing tracks are kept, so the same
# command resumes an interrupted run.
#
# Usage: pipelines/author-catalogue.sh [--jobs N] FILMS TRACKS [-- OPTION...]    by GNU parallel on this machine
#        pipelines/author-catalogue.sh --slurm FILMS TRACKS [-- OPTION...]       as a job array of Slurm; TRACKS on a shared disk
#        pipelines/author-catalogue.sh --table FILMS TRACKS                      the table only
#   OPTION  of tactile-track author, such as --rows=4
# The status is 0 if every film has its track.
set -euo pipefail

mode=parallel
jobs=$(nproc)
while [[ ${1:-} == --* ]]; do
  case $1 in
    --jobs) jobs=$2; shift ;;
    --slurm | --table | --task) mode=${1#--} ;;
    --help) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "author-catalogue.sh: unknown option '$1'; see --help" >&2; exit 2 ;;
  esac
  shift
done
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

# Paths of all films below the folder, NUL-terminated, in a fixed order.
list() {
  (cd -- "$films" && find . -type f -regextype posix-extended -iregex '.*\.(mkv|mp4|m4v|mov|webm|avi|ts|mpg|ogv)' -printf '%P\0' | sort -z)
}

# track FILM: path of its track: the same relative folder and the full name, since names may differ in the extension only
track() {
  printf '%s.vtt\n' "$tracks/$1"
}

# one FILM OPTION...
one() {
  local out
  out=$(track "$1")
  mkdir -p -- "$(dirname -- "$out")"
  tactile-track author --jobs=1 "$films/$1" -o "$out" "${@:2}"
}

table() {
  local film out information missing=0
  printf '%-40s %10s %6s\n' film "length (s)" "felt"
  while IFS= read -r -d '' film; do
    out=$(track "$film")
    if [ -f "$out" ] && information=$(tactile-track info "$out" 2>/dev/null); then
      awk -v film="$film" '/^Length/ { length_s = $2 } /^Felt/ { felt = substr($4, 2) " %" }
        END { printf "%-40s %10s %6s\n", film, length_s, felt }' <<<"$information"
    else
      printf '%-40s %10s\n' "$film" "no track"
      missing=$((missing + 1))
    fi
  done < <(list)
  echo "$missing without a track"
  [ "$missing" -eq 0 ]
}

case $mode in
  parallel)
    export -f one track
    export films tracks
    # A film that fails does not stop the others; Ctrl-C starts no further ones.
    list | parallel --null --jobs "$jobs" --line-buffer one {} "$@" || true
    table
    ;;
  slurm)
    count=$(list | tr -dc '\0' | wc -c)
    [ "$count" -gt 0 ] || { echo "author-catalogue.sh: no films in '$films'" >&2; exit 1; }
    # With --wait, sbatch returns after the last film, and fails if any film failed.
    sbatch --wait --quiet --job-name=author-catalogue --array="0-$((count - 1))" --cpus-per-task=1 --output="$tracks/slurm-%A-%a.log" \
      --wrap "$(printf '%q ' "$(realpath -- "$0")" --task "$films" "$tracks" -- "$@")" || true
    table
    ;;
  task)
    mapfile -d '' -t all < <(list)
    one "${all[$SLURM_ARRAY_TASK_ID]}" "$@"
    ;;
  table) table ;;
esac
