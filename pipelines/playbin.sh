#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film with tactile output in playbin3 or playbin. CHAIR may hold properties of visuotactilesink, as in CHAIR="rows=2 intensity=0.5".
# Usage: pipelines/playbin.sh FILM [playbin3|playbin]
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use

exec gst-launch-1.0 -e "${2:-playbin3}" uri="$film" video-sink="visuotactilesink ${CHAIR:-}"
