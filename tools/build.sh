# shellcheck shell=bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Functions that set up and build this checkout; sourced by pipelines/*.sh and tests/run.sh.
#
#   build_project DIRECTORY PARTS TARGETS [MESON_OPTION...]
#     PARTS: arguments of tools/setup.sh; TARGETS: ninja targets, all if empty; one word each
#
# Prints progress on a terminal, otherwise only errors. VISUOTACTILE_NO_SETUP=1 skips tools/setup.sh.

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
    # Remove what a failed configuration left behind.
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

# Builds what playing needs and sets GStreamer's paths, for the scripts in pipelines/. Sets `built`,
# the build folder. Optional inputs: `needs`, further arguments of tools/setup.sh; `targets`, further
# ninja targets; VISUOTACTILE_BUILD, a finished build folder to use instead.
build_and_use() {
  built=${VISUOTACTILE_BUILD:-$root/build}
  # Standard output is the pipeline's.
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
  # By bytes: file names may contain any byte, including special characters of URIs and launch lines.
  IFS= read -r -d '' path < <(realpath -z -- "$1")
  for ((i = 0; i < ${#path}; i++)); do
    case ${path:i:1} in
      [A-Za-z0-9/._~-]) uri+=${path:i:1} ;;
      *) uri+=$(printf '%%%02X' "$(($(printf '%d' "'${path:i:1}") & 255))") ;;
    esac
  done
  printf '%s\n' "$uri"
}
