#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays films with tactile output in GStreamer's own player: gst-play-1.0 with visuotactilesink as its video sink. A film's own
# tactile track is played, if it has one. CHAIR as in playbin.sh.
# Usage: pipelines/gst-play.sh FILM...
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film_uri "${1:-}" >/dev/null
# shellcheck disable=SC2034 # for build_and_use
needs=players
build_and_use

export GST_PLUGIN_FEATURE_RANK="tactilesubtitles:MAX${GST_PLUGIN_FEATURE_RANK:+,$GST_PLUGIN_FEATURE_RANK}"
exec gst-play-1.0 --videosink="visuotactilesink ${CHAIR:-}" "$@"
