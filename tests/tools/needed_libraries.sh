#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A library that is large or needs large ones is needed by a module alone, which is loaded only if
# it is used.
#
# Usage: needed_libraries.sh LIBRARY PLUGIN MODULE
set -euo pipefail
library=$1
needs() {
  readelf -d "$1" | grep -q "NEEDED.*$library"
}
needs "$3" || { echo "$3 does not need $library"; exit 1; }
! needs "$2" || { echo "$2 needs $library"; exit 1; }
