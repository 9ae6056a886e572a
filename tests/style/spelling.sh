#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Checks spelling, which is American English. .codespellrc lists what is left out, and why.
#
# Usage: spelling.sh SOURCE_FOLDER       To fix: codespell -w FILE
set -euo pipefail
cd "$1"
# For root in a user's checkout, too.
git -c safe.directory="$PWD" ls-files -z | xargs -0r codespell
