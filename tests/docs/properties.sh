#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Checks that an element's page names exactly the properties that the element adds to its base
# class.
# Usage: properties.sh DOCS_FOLDER ELEMENT...      (with the plugins on GST_PLUGIN_PATH)
set -euo pipefail
docs=$1
shift

# Properties of these base classes.
inherited=" name parent qos async blocksize enable-last-sample last-sample max-bitrate max-lateness processing-deadline render-delay stats sync throttle-time ts-offset do-timestamp num-buffers typefind async-handling message-forward emit-signals latency min-upstream-latency start-time start-time-selection "
status=0
for element in "$@"; do
  page=$docs/$element.md
  has=$(gst-inspect-1.0 "$element" | sed -n '/^Element Properties:/,$p' | sed -nE 's/^  ([a-z][a-z-]*) +: .*/\1/p' | sort -u)
  # The names in the first column of the property table.
  says=$(sed -n '/^| property /,/^$/p' "$page" | sed -nE 's/^\| ((`[a-z-]+`(, )?)+) .*/\1/p' | tr -d '`' | tr ',' '\n' | tr -d ' ' | sort -u)
  for name in $has; do
    if ! grep -qx -- "$name" <<<"$says" && [[ $inherited != *" $name "* ]]; then
      echo "$page does not tell of the property '$name'"
      status=1
    fi
  done
  for name in $says; do
    if ! grep -qx -- "$name" <<<"$has"; then
      echo "$page tells of '$name', which $element does not have"
      status=1
    fi
  done
done
exit $status
