#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs the tests of libraries and elements for arm64, cross-compiled, in an emulator. Boards on USB are left out: umockdev cannot stand between the
# emulator and the kernel.
#
# Usage: tests/machines/elements.sh BUILD_FOLDER [arguments of meson test]     (BUILD_FOLDER/machines is used; default: suites libs and elements)
#   CPU  one of QEMU's (default: cortex-a72, of a Raspberry Pi 4)
# Expects what `tools/setup.sh arm64` installs. An emulator is ten times as slow: tests may take twenty times as long.
set -euo pipefail
case ${1:-} in
  '' | -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../.." && pwd)
cross=$(cd "$1" && pwd)/machines/arm64-tests
shift
[ $# -gt 0 ] || set -- --suite libs --suite elements
folder=$("$here/target.sh" arm64-tests)
[ -f "$cross/build.ninja" ] || meson setup "$cross" "$source" --cross-file "$folder/meson.ini" "-Dcpp_args=--sysroot=$folder/root" \
  --auto-features=disabled -Dsaliency=enabled -Dpeople=enabled -Dgl=enabled -Dgamepad=enabled -Dwebsocket=enabled -Dtests=enabled
export CPU=${CPU:-cortex-a72} CK_TIMEOUT_MULTIPLIER=20 GST_PLUGIN_SYSTEM_PATH_1_0=$folder/root/usr/lib/aarch64-linux-gnu/gstreamer-1.0
meson test -C "$cross" --timeout-multiplier 20 --print-errorlogs "$@"
