#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# C and C++ are formatted as in .clang-format, with comments within 100 columns. Version 14, as in
# Debian 12: other versions break lines differently, so where it is not, only columns are checked.
#
# Usage: format.sh SOURCE_FOLDER         To fix: clang-format-14 -i FILE
set -euo pipefail
cd "$1"
# For root in a user's checkout, too.
files() {
  git -c safe.directory="$PWD" ls-files -z '*.c' '*.cpp' '*.h'
}
# It does not reformat or limit comments.
long=$(files | xargs -0r /usr/bin/python3 -c '
import sys
for name in sys.argv[1:]:
    for number, line in enumerate(open(name, encoding="utf-8"), 1):
        if len(line.rstrip("\n")) > 100:
            print(f"{name}:{number}: a line of {len(line) - 1} columns; expected 100 at most")')
[ -z "$long" ] || { printf '%s\n' "$long"; exit 1; }
command -v clang-format-14 >/dev/null || { echo "there is no clang-format-14, and other versions format otherwise"; exit 77; }
files | xargs -0r clang-format-14 --dry-run -Werror
