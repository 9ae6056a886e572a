#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Writes the commands that a chair would get for a film to commands.csv, as fast as the machine allows, without a picture.
# Usage: pipelines/commands.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
build_and_use

exec gst-launch-1.0 -e \
  uridecodebin uri="$film" ! queue ! videoconvert ! saliencytactile ! tactorsink sync=false trace-location=commands.csv
