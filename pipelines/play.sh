#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs dependencies, builds, and plays a film on screen and on the chair: a simulated one if no board is plugged in.
# Usage: pipelines/play.sh [options] [FILM]       pipelines/play.sh --help lists the options.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=../tools/build.sh
. "$here/../tools/build.sh"

build_and_use
exec "$root/build/tools/visuotactile-play" "$@"
