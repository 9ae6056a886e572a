#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film with tactile output in the C example of GstPlay (examples/gstplay.c).
# Usage: pipelines/gstplay.sh FILM [property=value ...]      (visuotactilesink's properties)
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
film=$(film_uri "${1:-}")
# shellcheck disable=SC2034 # for build_and_use
needs=players
targets=examples/gstplay
build_and_use

exec "$built/examples/gstplay" "$film" "${@:2}"
