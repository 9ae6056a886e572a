#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A 32-bit machine is refused, with the reason, before anything is looked for. This machine's compiler stands for the other's.
# Usage: bits.sh SOURCE_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for family in arm x86; do
  cat >"$work/$family.ini" <<INI
[binaries]
c = 'cc'
cpp = 'c++'
[properties]
needs_exe_wrapper = true
[host_machine]
system = 'linux'
cpu_family = '$family'
cpu = '$family'
endian = 'little'
INI
  ! meson setup "$work/$family" "$1" --cross-file "$work/$family.ini" >"$work/log" 2>&1 || { echo "expected a refusal of $family"; exit 1; }
  message=$(sed -n "s/.*ERROR: //p" "$work/log")
  case $message in
    *"expected a 64-bit machine (x86_64, aarch64), got $family: "*) ;;
    *) echo "expected the reason, got: $message"; exit 1 ;;
  esac
done
echo "32-bit Arm and x86 are refused"
