#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film whose picture and sound are both felt. MIX says how, as mix of tactilecombiner: max (the stronger, the default),
# accent, stress, sum or gate. CHAIR may hold properties of tactorsink, as in CHAIR="driver=simulator intensity=0.5".
# Usage: pipelines/sound.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use
lookahead="queue max-size-bytes=0 max-size-buffers=0 max-size-time=400000000"

# shellcheck disable=SC2086 # lookahead and CHAIR are words
exec gst-launch-1.0 -e \
  uridecodebin uri="$film" name=film \
  film. ! queue ! videoconvert ! saliencytactile ! queue ! tactilecombiner name=both mix="${MIX:-max}" ! tactileextractor name=split \
  split.src ! $lookahead ! tactileoverlay ! videoconvert ! ${VIDEO_SINK:-autovideosink} \
  split.tactile ! $lookahead ! tactorsink ${CHAIR:-} \
  film. ! queue ! audioconvert ! soundtactile name=sound \
  sound.src ! $lookahead ! audioconvert ! audioresample ! ${AUDIO_SINK:-autoaudiosink} \
  sound.tactile ! queue ! both.tactile
