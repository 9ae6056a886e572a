#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Words are spelled right, and in American English. What is left out, and why: .codespellrc.
#
# Usage: spelling.sh SOURCE_FOLDER       To mend: codespell -w FILE
set -euo pipefail
cd "$1"
# Also where root looks at a user's checkout.
git -c safe.directory="$PWD" ls-files -z | xargs -0r codespell
