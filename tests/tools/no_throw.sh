#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Nothing in lib/ or gst/ throws: expected errors are values (docs/design/architecture.md,
# "Errors"). Object files are checked rather than sources, since headers may throw, too. Of the
# exceptions of the standard library itself some are found, but not std::vector's when memory is
# exhausted.
#
# Usage: no_throw.sh BUILD
set -euo pipefail
cd "$1"

# RowBuffer (lib/frame/image_rows.h) throws std::bad_alloc, like a vector.
allowed='^lib/(frame/.*/(byte_rows|component_rows|front_end)|saliency/.*/pyramid)\.cpp\.o$'

mapfile -d '' objects < <(find lib gst -name '*.o' -print0)
[ ${#objects[@]} -gt 50 ] || { echo "only ${#objects[@]} objects in $1" >&2; exit 1; }
# -A: the file's name on each line.
throwing=$(nm -A --undefined-only "${objects[@]}" | sed -n 's/:.* U __cxa_throw$//p' | sort)
unexpected=$(grep -Ev "$allowed" <<<"$throwing" || true)
if [ -n "$unexpected" ]; then
  printf 'These throw; what they tell has to be a value (tl::expected), or an assertion:\n%s\n' "$unexpected" >&2
  exit 1
fi

# What the standard library throws where something is missing, and no bug: no more threads, a file
# system's errors, text that is no number. Each has a form that returns the error.
errors=' std::(thread::_M_start_thread|filesystem::[a-z_]+\(|__throw_(invalid_argument|regex_error)|filesystem::.*directory_iterator::operator\+\+)'
calling=$(nm -AC --undefined-only "${objects[@]}" | grep -E "$errors" | grep -v 'std::error_code' || true)
if [ -n "$calling" ]; then
  printf 'These call what throws where a thread, a file or a number is missing:\n%s\n' "$calling" >&2
  exit 1
fi
echo "${#objects[@]} objects, none that throws but where memory is out:"
echo "$throwing"
