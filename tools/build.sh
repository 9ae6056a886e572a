# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by pipelines/play.sh and tests/run.sh: sets up and builds this checkout.
#   build_project DIRECTORY PARTS [meson options]   PARTS: what tools/setup.sh shall install, in one word
# Quiet unless something goes wrong; VISUOTACTILE_NO_SETUP=1 skips the installation.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build_project() {
  local directory=$1 parts=$2 log
  shift 2
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
  if ! ninja -C "$directory" -n 2>/dev/null | grep -q 'no work to do'; then
    echo "Building ..."
  fi
  ninja -C "$directory" >"$log" 2>&1 || { cat "$log" >&2; rm -f "$log"; return 1; }
  rm -f "$log"
}
