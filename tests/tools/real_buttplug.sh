#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A feel-test on a real Buttplug server, by hand: it is npm's buttplug-wasm, in node, with a device on a simulated Bluetooth. Each motor gets its
# level and its zero. A device that never confirms a level is told its zero all the same, at once: before the server is left.
#
# Usage: tests/tools/real_buttplug.sh [BUILD]    BUILD: a build folder, default build. Installs buttplug-wasm and ws into BUILD/buttplug.
# Needs node, npm and the network.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
case ${1:-} in -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
build=$(realpath "${1:-$root/build}")
mkdir -p "$build/buttplug"
cd "$build/buttplug"
[ -d node_modules/buttplug-wasm ] || npm install --no-audit --no-fund buttplug-wasm@2.0.1 ws@8

fail() {
  echo "$*"
  exit 1
}
# feel NAME STATUS [hold]: the server's lines are in NAME
feel() {
  local name=$1 expected=$2 status=0 port
  shift 2
  node "$root/tests/tools/real_buttplug.mjs" "$@" >"$name" 2>&1 &
  local server=$!
  # shellcheck disable=SC2064
  trap "kill $server" EXIT
  until port=$(grep -m 1 -oP '^port \K.*' "$name"); do
    kill -0 $server || fail "the server ended: $(cat "$name")"
    sleep 0.1
  done
  timeout 60 meson devenv -C "$build" visuotactile-play --feel-test --driver=intiface --device="Aneros Vivi@127.0.0.1:$port" >"$name.said" 2>&1 || status=$?
  kill $server
  trap - EXIT
  [ "$status" -eq "$expected" ] || fail "$name: status $status instead of $expected: $(cat "$name.said")"
}

feel answers 0
for motor in 1 2; do
  [ "$(grep -cx "write f${motor}7f" answers)" -eq 1 ] || fail "motor $motor does not get its level once: $(cat answers)"
  [ "$(grep "^write f$motor" answers | tail -n 1)" = "write f${motor}00" ] || fail "motor $motor does not end at zero: $(cat answers)"
done

feel holds 0 hold
awk '!level && /^got .*"Scalar":(1|0\.)/ { level = 1; next } level && /^got / { print; exit }' holds >next
grep -q '"Scalar":0,' next || fail "expected a zero as the next message after the level, got: $(cat next)"
echo "a real Buttplug server gets each level, and each zero at once"
