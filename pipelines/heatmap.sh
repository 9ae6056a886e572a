#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film with its saliency map as a color overlay.
# Usage: pipelines/heatmap.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use

exec gst-launch-1.0 -e \
  uridecodebin uri="$film" ! queue ! videoconvert ! saliencytactile attach-saliency=true ! tactileoverlay style=heatmap \
  ! videoconvert ! autovideosink
