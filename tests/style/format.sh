#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# C and C++ are formatted as .clang-format says. Version 14, Debian 12's: others break lines elsewhere.
#
# Usage: format.sh SOURCE_FOLDER         To mend: clang-format-14 -i FILE
set -euo pipefail
cd "$1"
# Also where root looks at a user's checkout.
git -c safe.directory="$PWD" ls-files -z '*.c' '*.cpp' '*.h' | xargs -0r clang-format-14 --dry-run -Werror
