#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# What tools/setup.sh says and does where apt knows a name and where not, is locked, offline or missing; and that Build-Depends are installed.
# apt-get, apt-cache and dpkg-query are stand-ins.
# Usage: setup.sh SOURCE_FOLDER
set -euo pipefail
source=$1
setup=$source/tools/setup.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "$1" >&2
  [ ! -s "$work/said" ] || sed 's/^/  /' "$work/said" >&2
  exit 1
}

# stand_in NAME SCRIPT
stand_in() {
  printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}

# Nothing is installed, apt knows all but the packages in $work/unknown. `apt-get` writes what it is asked to $work/asked.
reset() {
  rm -rf "${work:?}"/{bin,asked,unknown,naps}
  mkdir "$work/bin"
  touch "$work/unknown" "$work/asked" "$work/naps"
  stand_in dpkg-query 'exit 1'
  stand_in apt-cache "grep -qx \"\$2\" $work/unknown || { printf '%s:\n  Installed: (none)\n  Candidate: 1\n' \"\$2\"; seq 20000; }"
  stand_in apt-get "echo \"\$@\" >>$work/asked; $1"
  stand_in sudo "exec \"\$@\""
  stand_in sleep "echo >>$work/naps"
}

# says STATUS WORDS: of `setup.sh packages`
says() {
  local status=0
  PATH=$work/bin:$PATH bash "$setup" packages >"$work/said" 2>&1 || status=$?
  [ "$status" -eq "$1" ] || fail "expected status $1, got $status:"
  grep -qF "$2" "$work/said" || fail "expected '$2', got:"
}

reset 'exit 0'
says 0 "Installing: "
grep -q 'install -y .*lintian' "$work/asked" || fail "lintian was not asked for"

reset 'exit 0'
printf 'lintian\ngi-docgen\n' >"$work/unknown"
says 1 "has no packages of these names, so nothing was installed: gi-docgen lintian"
! grep -q online "$work/said" || fail "a name that does not exist is no matter of the network:"
! grep -q install "$work/asked" || fail "some packages were asked for all the same"

reset 'echo "W: Failed to fetch http://mirror.example/debian/InRelease  Temporary failure resolving" '
printf 'lintian\n' >"$work/unknown"
says 1 "is this machine online?"

reset 'case $* in *install*) echo "E: Unmet dependencies."; exit 100 ;; esac'
says 1 "apt-get could not install them"
! grep -q online "$work/said" || fail "broken dependencies are no matter of the network:"

# Held for three tries, then free.
lock='echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (unattended-upgr)"; exit 100'
reset "[ \$(wc -l <$work/asked) -gt 3 ] || { $lock; }"
says 0 "Waiting while another program installs packages: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (unattended-upgr)"
[ "$(grep -c Waiting "$work/said")" -eq 1 ] || fail "that is said once:"
[ "$(wc -l <"$work/naps")" -eq 3 ] || fail "expected 3 naps, got $(wc -l <"$work/naps")"

reset "$lock"
says 1 "another program still installs packages after 10 minutes"
! grep -q online "$work/said" || fail "a lock is no matter of the network:"

# Where there is no apt-get: only what this script and setup.sh need.
mkdir "$work/few"
for program in bash cat grep sed; do
  ln -s "$(command -v "$program")" "$work/few/$program"
done
status=0
PATH=$work/few bash "$setup" packages >"$work/said" 2>&1 || status=$?
[ "$status" -eq 1 ] || fail "expected status 1 without apt-get, got $status:"
grep -qF 'this is not Debian or Ubuntu, so nothing was installed' "$work/said" || fail "expected a list of packages, got:"

# names RELEASE PART...
names() {
  local release=$1
  shift
  bash "$setup" --names="$release" "$@"
}
: >"$work/said"
for release in debian-12 debian-13 debian-sid ubuntu-24.04 fedora; do
  [ "$(names "$release" build | wc -l)" -ge 15 ] || fail "$release: expected the names of compiler and libraries, got: $(names "$release" build)"
done
[ "$(names debian-13 fuzz | tail -n 1)" = libclang-rt-19-dev ] || fail "Debian 13 has libclang-rt-19-dev, got: $(names debian-13 fuzz)"
[ "$(names debian-sid test | grep -c -e clang-format -e media-gstreamer)" = 0 ] || fail "sid has no clang-format-14 or libgtk-4-media-gstreamer"
[ "$(names fedora build | head -n 1)" = gcc-c++ ] || fail "Fedora's compiler is gcc-c++"
! bash "$setup" --names=potato 2>/dev/null || fail "--names=potato: expected a refusal"

# What builds the packages is installed before they are built. Two names are virtual.
comm -13 <(names debian-12 build packages | sort -u) \
  <(sed -n '/^Build-Depends/,/^[A-Z][^:]*: /{ s/^Build-Depends[^:]*://; /^[A-Z]/d; s/([^)]*)//g; s/<[^>]*>//g; s/[, ]\+/\n/g; p }' "$source/debian/control" |
    sed 's/^debhelper-compat$/debhelper/; s/^dh-sequence-gir$/gobject-introspection/; /^$/d' | sort -u) >"$work/said"
[ ! -s "$work/said" ] || fail "debian/control has Build-Depends that 'tools/setup.sh build packages' does not install:"
echo "setup.sh: names, locks and networks are told apart"
