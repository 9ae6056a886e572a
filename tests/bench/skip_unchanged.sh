#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Maps of films with skip-unchanged against those without: how many differ, by how much, and whether each cell's onsets are on the same frames.
#
# Usage: tests/bench/skip_unchanged.sh FILM...       needs GST_PLUGIN_PATH, as in `meson devenv -C build`
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
many=(max-size-time=0 max-size-bytes=0 max-size-buffers=0)
for film; do
  for skips in true false; do
    gst-launch-1.0 -q filesrc location="$film" ! decodebin ! videoconvert ! saliencytactile skip-unchanged=$skips ! tactileextractor name=x \
      x.src ! queue "${many[@]}" ! fakesink sync=false x.tactile ! queue "${many[@]}" ! filesink location="$work/$skips" >/dev/null
  done
  /usr/bin/python3 - "$film" "$work" <<'END'
import sys
import numpy as np

with_it, without = (np.fromfile(f"{sys.argv[2]}/{name}", np.float32).reshape(-1, 9) for name in ("true", "false"))
assert len(with_it) == len(without), (len(with_it), len(without))
apart = np.abs(with_it - without).max(1)
onsets = [(maps[1:] > 0) & (maps[:-1] == 0) for maps in (with_it, without)]
print(f"{sys.argv[1].split('/')[-1]}: {(apart > 0).sum()} of {len(apart)} maps differ, by {apart.max():.4f} at most; "
      f"{onsets[1].sum()} onsets, {(onsets[0] != onsets[1]).sum()} elsewhere")
END
done
