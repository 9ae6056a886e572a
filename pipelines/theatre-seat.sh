#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A seat of a theatre: plays the stream of theatre-server.sh on the motors of one chair (examples/theatre_seat.py).
# Usage: pipelines/theatre-seat.sh SERVER [options]      (--help lists them)
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
# shellcheck disable=SC2034 # for build_and_use
needs=players
build_and_use

exec /usr/bin/python3 "$root/examples/theatre_seat.py" "$@"
