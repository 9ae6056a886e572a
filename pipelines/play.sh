#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, plays a film on screen and on the simulated chair.
# Usage: pipelines/play.sh [options] [FILM]       pipelines/play.sh --help lists the options.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../tools/build.sh
. "$here/../tools/build.sh"

# Progress of the set-up goes where the film's progress goes; what is printed is the report.
build_project "$root/build" "build play" >&2

export GST_PLUGIN_PATH="$root/build/gst${GST_PLUGIN_PATH:+:$GST_PLUGIN_PATH}"
export GST_REGISTRY="$root/build/registry.bin"
exec "$root/build/tools/visuotactile-play" "$@"
