#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Draws the tactile map of a film in the terminal (examples/terminal.py).
# Usage: pipelines/terminal.sh FILM
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
# shellcheck disable=SC2034 # for build_and_use
needs=players
targets=lib/gst/tactile/GstTactile-1.0.typelib
build_and_use

export GI_TYPELIB_PATH="$built/lib/gst/tactile${GI_TYPELIB_PATH:+:$GI_TYPELIB_PATH}"
export LD_LIBRARY_PATH="$built/lib/gst/tactile${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
exec /usr/bin/python3 "$root/examples/terminal.py" "$film"
