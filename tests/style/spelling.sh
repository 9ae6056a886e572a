#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Checks spelling, which is American English. .codespellrc lists what is left out, and why. Version 2.2, as in Debian 12: others know other words.
#
# Usage: spelling.sh SOURCE_FOLDER       To fix: codespell -w FILE
set -euo pipefail
cd "$1"
version=$(codespell --version 2>/dev/null || true)
case $version in
  2.2.*) ;;
  *) echo "codespell is ${version:-missing}; this test is for 2.2"; exit 77 ;;
esac
# Without texts in other languages. For root in a user's checkout, too.
git -c safe.directory="$PWD" ls-files -z ':!po' ':!data/app' | xargs -0r codespell
