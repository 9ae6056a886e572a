#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs a command where the window's packages are installed: over this machine, of which nothing is changed. As root, of Debian 12 or 13.
#
# Usage: tests/app/installed.sh PACKAGES COMMAND...     PACKAGES: the folder that tools/packages.sh has filled
set -euo pipefail
packages=$(realpath "$1")
shift
export packages here=$PWD
exec unshare --mount --pid --fork --kill-child bash -euo pipefail -c '
  top=$(mktemp -d)
  mount -t tmpfs none "$top"
  mkdir "$top"/{changes,work,root} "$top/changes/packages"
  cp "$packages"/*.deb "$top/changes/packages"
  mount -t overlay none -o "lowerdir=/,upperdir=$top/changes,workdir=$top/work" "$top/root"
  cd "$top/root"
  mount -t proc none proc
  for each in dev sys; do mount --rbind "/$each" "$each"; done
  mount -t tmpfs none tmp
  exec chroot . bash -euo pipefail -c "
    begin=\$SECONDS
    apt-get -qq install -y --no-install-recommends /packages/{visuotactile,visuotactile-tools,gstreamer1.0-visuotactile{,-gamepad,-websocket},libgsttactile-1.0-0}_*.deb >/dev/null
    export INSTALLED=\"The packages of visuotactile were installed in \$((SECONDS - begin)) s on a machine that has what they depend on.\"
    cd \"\$here\"
    exec \"\$@\"" - "$@"
' - "$@"
