#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# OpenCV's object detection, which needs large libraries, is needed by the face detector alone, a
# module that is loaded only if people are looked for.
#
# Usage: needed_libraries.sh PLUGIN MODULE
set -euo pipefail
needs() {
  readelf -d "$1" | grep -q 'NEEDED.*opencv_objdetect'
}
needs "$2" || { echo "$2 does not need opencv_objdetect"; exit 1; }
! needs "$1" || { echo "$1 needs opencv_objdetect"; exit 1; }
