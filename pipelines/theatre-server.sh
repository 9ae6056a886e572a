#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Plays a film and streams its tactile maps to the seats of a theatre (examples/theatre_server.py).
# Usage: pipelines/theatre-server.sh FILM [options]      (--help lists them)
set -euo pipefail
# shellcheck source=../tools/build.sh
. "$(dirname "$0")/../tools/build.sh"
# shellcheck disable=SC2034 # for build_and_use
needs=players
build_and_use

exec /usr/bin/python3 "$root/examples/theatre_server.py" "$@"
