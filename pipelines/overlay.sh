#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film with the tactile grid as an overlay, and on the chair: a simulated one if no board is plugged in.
# Usage: pipelines/overlay.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use
lookahead="queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000"

# shellcheck disable=SC2086 # lookahead is an element and its properties
exec gst-launch-1.0 -e \
  uridecodebin uri="$film" ! queue ! videoconvert ! saliencytactile ! tactileextractor name=split \
  split.src ! $lookahead ! tactileoverlay ! videoconvert ! autovideosink \
  split.tactile ! $lookahead ! tactorsink
