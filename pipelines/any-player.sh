#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs any player with tactile output. visuotactilesink gets the highest rank of all video sinks, and tactilesubtitles that of all
# subtitle renderers, so that a film's own tactile track is played. This works with players that leave the choice of the video sink
# to playbin or autovideosink.
# Usage: pipelines/any-player.sh PLAYER [ARGUMENT...]      for example: pipelines/any-player.sh gst123 FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
[ $# -gt 0 ] || { echo "any-player.sh: expected a player; usage: $0 PLAYER [ARGUMENT...]" >&2; exit 2; }
build_and_use

export GST_PLUGIN_FEATURE_RANK="visuotactilesink:MAX,tactilesubtitles:MAX${GST_PLUGIN_FEATURE_RANK:+,$GST_PLUGIN_FEATURE_RANK}"
exec "$@"
