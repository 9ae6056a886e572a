# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by pipelines/play.sh and tests/run.sh: sets up and builds this checkout.
#   build_project DIRECTORY PARTS TARGETS [meson options]   PARTS: what tools/setup.sh shall install; TARGETS: what ninja shall build, all if
#   empty; each in one word
# Shows progress on a terminal, else nothing unless something goes wrong; VISUOTACTILE_NO_SETUP=1 skips the installation.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build_project() {
  local directory=$1 parts=$2 targets=$3 log
  shift 3
  if [ -z "${VISUOTACTILE_NO_SETUP:-}" ]; then
    # shellcheck disable=SC2086 # PARTS is a list of words
    "$root/tools/setup.sh" $parts || return 1
  fi
  log=$(mktemp)
  if [ ! -f "$directory/build.ninja" ]; then
    echo "Configuring ..."
    # A directory left behind by a configuration that failed is begun anew.
    rm -rf "$directory"
    meson setup "$directory" "$root" "$@" >"$log" 2>&1 || { cat "$log" >&2; rm -rf "$directory" "$log"; return 1; }
  elif [ $# -gt 0 ]; then
    meson configure "$directory" "$@" >"$log" 2>&1 || { cat "$log" >&2; rm -f "$log"; return 1; }
  fi
  # shellcheck disable=SC2086 # TARGETS is a list of words
  if ninja -C "$directory" -n $targets 2>/dev/null | grep -q 'no work to do'; then
    rm -f "$log"
  elif [ -t 1 ]; then
    rm -f "$log"
    NINJA_STATUS="Building %f of %t: " ninja -C "$directory" $targets
  else
    echo "Building ..."
    ninja -C "$directory" $targets >"$log" 2>&1 || { cat "$log" >&2; rm -f "$log"; return 1; }
    rm -f "$log"
  fi
}

# Builds what playing needs and makes GStreamer find it, for the scripts in pipelines/. `needs` may name more that tools/setup.sh shall install,
# `targets` more that ninja shall build.
# Sets `built`, the folder; VISUOTACTILE_BUILD names one in which all is built already.
build_and_use() {
  built=${VISUOTACTILE_BUILD:-$root/build}
  # What is printed on standard output belongs to the pipeline.
  [ -n "${VISUOTACTILE_BUILD:-}" ] || build_project "$built" "build play ${needs:-}" "play ${targets:-}" >&2
  export GST_PLUGIN_PATH="$built/gst${GST_PLUGIN_PATH:+:$GST_PLUGIN_PATH}"
  export GST_REGISTRY="${GST_REGISTRY_1_0:-$built/registry.bin}"
}

# The URI of a film given as a path or a URI.
film_uri() {
  local LC_ALL=C path uri=file:// i
  case $1 in
    "") echo "$(basename "$0"): expected a film; usage: $0 FILM" >&2; return 2 ;;
    *://*) printf '%s\n' "$1"; return ;;
  esac
  [ -f "$1" ] || { echo "$(basename "$0"): there is no film '$1'" >&2; return 1; }
  # Byte by byte: a name may hold any, also such that mean something in a URI or on a launch line.
  IFS= read -r -d '' path < <(realpath -z -- "$1")
  for ((i = 0; i < ${#path}; i++)); do
    case ${path:i:1} in
      [A-Za-z0-9/._~-]) uri+=${path:i:1} ;;
      *) uri+=$(printf '%%%02X' "$(($(printf '%d' "'${path:i:1}") & 255))") ;;
    esac
  done
  printf '%s\n' "$uri"
}
