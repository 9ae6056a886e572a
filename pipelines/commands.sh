#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes the motor commands for a film to commands.csv, without a picture and faster than real time if possible.
# Usage: pipelines/commands.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use

# Renamed when complete: a film that cannot be played leaves an existing file unchanged.
part=.commands.csv.$$.part
trap 'rm -f "$part"' EXIT
gst-launch-1.0 -e \
  uridecodebin uri="$film" ! queue ! videoconvert ! saliencytactile ! tactorsink driver=simulator sync=false trace-location="$part"
mv "$part" commands.csv
