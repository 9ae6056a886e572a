#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes the commands that a chair would get for a film to commands.csv, as fast as the machine allows, without a picture.
# Usage: pipelines/commands.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use

# Under its name only when it is complete: a film that can't be played leaves what is there.
part=.commands.csv.$$.part
trap 'rm -f "$part"' EXIT
gst-launch-1.0 -e \
  uridecodebin uri="$film" ! queue ! videoconvert ! saliencytactile ! tactorsink driver=simulator sync=false trace-location="$part"
mv "$part" commands.csv
