#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# README's instructions for installing are true. Its lines run with a temporary prefix, but without
# the build. Then GStreamer, programs, Python and pkg-config must find everything in an otherwise
# empty environment. With its prefix for all users, plugins must be where GStreamer looks.
# Usage: install.sh README BUILD PYTHON pages|no-pages      (a build folder in which everything to
# install is built, with or without manual pages)
set -euo pipefail
readme=$1
build=$2
python=$3
pages=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The shell blocks under "Installing".
# shellcheck disable=SC2016 # back ticks of Markdown
section=$(sed -n '/^## Installing$/,/^## More$/p' "$readme")
# shellcheck disable=SC2016
blocks=$(sed -n '/^```sh$/,/^```$/p' <<<"$section")
[ -n "$blocks" ] || { echo "$readme says nothing of installing"; exit 1; }

# ---- all users: plugins must be in GStreamer's own folder ------------------------------------
option() {
  meson introspect "$build" --buildoptions | "$python" -c 'import json, sys; print(next(o["value"] for o in json.load(sys.stdin) if o["name"] == sys.argv[1]))' "$1"
}
prefix=$(sed -nE 's/^meson setup build --prefix=(\/[a-z/]+) .*/\1/p' <<<"$blocks")
[ -n "$prefix" ] || { echo "$readme names no prefix for all users"; exit 1; }
[ "$prefix/$(option libdir)/gstreamer-1.0" = "$(pkg-config --variable=pluginsdir gstreamer-1.0)" ] || { echo "GStreamer does not look below $prefix"; exit 1; }

# ---- other prefixes -------------------------------------------------------------------------
# Staged, then the one file that contains the prefix is changed as if it had been configured.
DESTDIR=$work/stage meson install -C "$build" --no-rebuild --quiet
mv "$work/stage$(option prefix)" "$work/there"
sed -i "s#^prefix=.*#prefix=$work/there#" "$work"/there/lib/*/pkgconfig/*.pc
# shellcheck disable=SC2016
sed -n '/^prefix=/,/^```$/{/^```$/d;p}' <<<"$blocks" | sed "s#^prefix=.*#prefix=$work/there#; /meson install/d" >"$work/environment"
grep -q '^export' "$work/environment" || { echo "$readme says nothing of other prefixes"; exit 1; }

# found COMMAND: it must succeed in a shell that has read only README's lines
found() {
  env -i PATH="$PATH" HOME="$work" GST_REGISTRY="$work/registry" bash -euc ". '$work/environment'; $1" >"$work/log" 2>&1 || {
    printf 'with what README says, this fails: %s\n' "$1"
    tail -n 20 "$work/log"
    exit 1
  }
}
# shellcheck disable=SC2016
elements=$(sed -nE 's/^- \[`([a-z]+)`\]\(docs\/elements.*/\1/p' "$readme" | grep -v provider) # gst-inspect-1.0 knows no device providers
[ "$(wc -w <<<"$elements")" -ge 10 ] || { echo "$readme lists hardly any element: $elements"; exit 1; }
for element in $elements; do
  found "gst-inspect-1.0 $element | grep -F '$work/there'"
done
found "gst-launch-1.0 -q tactiletestsrc num-buffers=2 ! saliencytactile ! tactorsink driver=simulator sync=false"
for program in visuotactile-play tactile-track tactor-calibrate visuotactile-settings visuotactile-follow visuotactile-study visuotactile; do
  found "[ \"\$(command -v $program)\" = '$work/there/bin/$program' ] && $program --version"
  [ "$pages" = no-pages ] || [ -s "$work/there/share/man/man1/$program.1" ] || { echo "no manual page of $program in $work/there"; exit 1; }
done
for file in lib/systemd/user/visuotactile-follow.service share/dbus-1/services/org.visuotactile.Follow1.service; do
  grep -qE "^Exec(Start)?=.*/bin/visuotactile-follow$" "$work/there/$file" || { echo "$file is not as expected:"; cat "$work/there/$file"; exit 1; }
done
found "$python -c 'import gi; gi.require_version(\"Gst\", \"1.0\"); gi.require_version(\"GstTactile\", \"1.0\"); from gi.repository import Gst, GstTactile; Gst.init(None); assert GstTactile.buffer_get_tactile_meta(Gst.Buffer.new()) is None'"
cat >"$work/application.c" <<'C'
#include <gst/tactile/tactile.h>
int
main(void)
{
  GstCaps *caps;
  gst_init(NULL, NULL);
  caps = gst_tactile_map_caps_new(3, 3, 25, 1);
  gst_caps_unref(caps);
  return 0;
}
C
found "cc -Wall -Werror -o '$work/application' '$work/application.c' \$(pkg-config --cflags --libs gstreamer-tactile-1.0) && '$work/application'"
echo "$(wc -w <<<"$elements") elements, three programs, Python and C find what is installed"
