#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes the pictures of all windows and pages in docs/images: the window and the film's, the desk, the study. FILM is shown in the desk.
#
# Usage: meson devenv -C build ../tests/pictures.sh FILM
set -euo pipefail
here=$(dirname "$(realpath "$0")")
images=$(realpath "$here/../docs/images")
film=$(realpath "$1")
export TRACK=$PWD/tools/tactile-track STUDY=$PWD/tools/visuotactile-study
APP=$PWD/tools/visuotactile "$here/app/screenshots.py" "$images/app"
/usr/bin/python3 "$here/desk/pictures.py" "$film" "$images/desk"
/usr/bin/python3 "$here/study/pictures.py" "$images/study"
