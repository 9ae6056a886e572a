#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds Debian packages of this checkout and checks them with lintian.
#
# Usage: tools/packages.sh [--cross=ARCHITECTURE] [DIRECTORY]     (default: this machine's, packages)
#   --cross  for another machine, without documentation, manual pages and introspection data, on one where dpkg knows the architecture
#
# Installs its dependencies first, as root or with sudo; VISUOTACTILE_NO_SETUP=1 skips that. Packages tracked files, including uncommitted
# changes. DIRECTORY receives packages, sources and the build log; set DEB_BUILD_OPTIONS='' for packages of debug symbols.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
of=()
unchecked=()
case ${1:-} in
  -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
  --cross=*)
    of=(--host-arch "${1#--cross=}" '--build-profiles=cross,nocheck,nodoc' --build=any)
    # These pages are what the programs print with --help.
    unchecked=(--suppress-tags no-manual-page)
    export VISUOTACTILE_NO_SETUP=1
    shift
    ;;
esac
[ -n "${VISUOTACTILE_NO_SETUP:-}" ] || "$root/tools/setup.sh" build packages
mkdir -p "${1:-packages}"
packages=$(cd "${1:-packages}" && pwd)

version=$(sed -n "s/^  version: '\(.*\)',/\1/p" "$root/meson.build")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
source=$work/visuotactile-$version
mkdir "$source"
# Root may run this in a user's checkout.
git=(git -c safe.directory="$root" -C "$root")
tracked=$("${git[@]}" stash create)
"${git[@]}" archive "${tracked:-HEAD}" | tar -x -C "$source"
tar -c -J -C "$work" --exclude=visuotactile-"$version"/debian --sort=name --owner=0 --group=0 --numeric-owner \
  -f "$work/visuotactile_$version.orig.tar.xz" "visuotactile-$version"

export DEB_BUILD_OPTIONS=${DEB_BUILD_OPTIONS-noautodbgsym}
echo "Building ..."
log=$packages/build.log
if ! (cd "$source" && dpkg-buildpackage --no-sign "${of[@]}") >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "packages.sh: the packages could not be built; all of it is in $log" >&2
  exit 1
fi
rm -f "$packages"/*visuotactile*_"$version"* "$packages"/*gsttactile*_"$version"*
find "$work" -maxdepth 1 -type f -exec mv -t "$packages" {} +
# By default, lintian refuses to run as root.
lintian --allow-root "${unchecked[@]}" --fail-on error,warning "$packages"/visuotactile_"$version"*.changes
ls -l "$packages"/*.deb
