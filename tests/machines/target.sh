#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes a folder with the libraries of another machine, to compile for it and to run that in an emulator. It needs no root: nothing is installed
# here, and this machine's dpkg learns of no other architecture. Prints the folder, in which are
#   root/      what Debian's packages of the architecture hold
#   meson.ini  the cross file
#   run        runs a program of the architecture, emulated; $CPU is one of qemu's, instead of its fullest
#
# Usage: tests/machines/target.sh [arm64 [RELEASE [FOLDER]]]      (default: arm64, this machine's release, a folder in the user's cache)
#
# Expects what `tools/setup.sh arm64` installs. Does nothing if the folder is complete.
set -euo pipefail
case ${1:-} in
  -h | --help) sed -n '3,11s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
architecture=${1:-arm64}
# shellcheck disable=SC1091 # the machine's
here=$(. /etc/os-release && echo "$VERSION_CODENAME")
release=${2:-$here}
folder=${3:-${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/visuotactile/machines/$release-$architecture}

fail() {
  echo "target.sh: $1" >&2
  exit 1
}
[ "$architecture" = arm64 ] || fail "expected arm64, got '$architecture'"
triplet=aarch64-linux-gnu
emulator=qemu-aarch64
for program in $triplet-g++ $emulator; do
  command -v "$program" >/dev/null || fail "there is no $program: run tools/setup.sh arm64"
done

# What the plugins are built with, but for modules, which need four times as much; and what plays films to them.
packages="libc6-dev libstdc++-$($triplet-gcc -dumpversion)-dev libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev libopencv-core-dev libopencv-imgproc-dev
  libhwy-dev libexpected-dev libusb-1.0-0-dev libjson-glib-dev libxml2-dev gstreamer1.0-tools gstreamer1.0-plugins-base"
# One at a time: another checkout may make the same folder.
mkdir -p "$(dirname "$folder")"
exec 9>"$folder.lock"
flock 9
if [ "$(cat "$folder/complete" 2>/dev/null)" = "$packages" ]; then
  echo "$folder"
  exit 0
fi
rm -rf "$folder"
mkdir -p "$folder"/root "$folder"/apt/{lists,archives}/partial "$folder"/apt/etc/{apt.conf,preferences}.d
folder=$(cd "$folder" && pwd)
root=$folder/root

# An apt of the folder's own, which downloads from where this machine's does.
# shellcheck disable=SC2016 # apt's field
mirror=$(apt-get indextargets --no-release-info --format '$(REPO_URI)' 'Created-By: Packages' "Release: $here" | sed -n 1p)
[ -n "$mirror" ] || fail "apt has no source of Debian's packages for '$here'"
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $release main" >"$folder/apt/etc/sources.list"
touch "$folder/apt/status"
cat >"$folder/apt/apt.conf" <<CONF
Dir::Etc "$folder/apt/etc";
Dir::State "$folder/apt";
Dir::State::status "$folder/apt/status";
Dir::State::lists "$folder/apt/lists";
Dir::Cache "$folder/apt";
Dir::Cache::archives "$folder/apt/archives";
APT::Architecture "$architecture";
APT::Architectures { "$architecture"; };
APT::Install-Recommends "false";
APT::Sandbox::User "";
Acquire::Languages "none";
Debug::NoLocking "true";
CONF
export APT_CONFIG=$folder/apt/apt.conf
# shellcheck disable=SC2086 # a list of words
{ apt-get -qq update && apt-get -qq install --download-only -y $packages; } >"$folder/log" 2>&1 || { tail -n 20 "$folder/log" >&2; fail "apt-get could not download the packages (see above)"; }
for package in "$folder"/apt/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -x -C "$root" --exclude=./usr/share/doc --exclude=./usr/share/man --exclude=./usr/share/locale
done
rm -rf "$folder/apt"

# Links to absolute paths are within the folder; of two that Debian's alternatives make, the packages' own scripts would.
find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
  ln -sfnr "$root$target" "$link"
done
for library in blas lapack; do
  ln -sfr "$root/usr/lib/$triplet/$library/lib$library.so.3" "$root/usr/lib/$triplet/"
done

cache=
! command -v ccache >/dev/null || cache="'ccache', "
cat >"$folder/meson.ini" <<INI
[binaries]
c = [$cache'$triplet-gcc']
cpp = [$cache'$triplet-g++']
ar = '$triplet-ar'
strip = '$triplet-strip'
pkgconfig = 'pkg-config'

[built-in options]
c_args = ['--sysroot=$root']
c_link_args = ['--sysroot=$root']
cpp_args = ['--sysroot=$root']
cpp_link_args = ['--sysroot=$root']

[properties]
sys_root = '$root'
pkg_config_libdir = ['$root/usr/lib/$triplet/pkgconfig', '$root/usr/share/pkgconfig']
needs_exe_wrapper = true

[host_machine]
system = 'linux'
cpu_family = 'aarch64'
cpu = 'aarch64'
endian = 'little'
INI
cat >"$folder/run" <<RUN
#!/bin/sh
exec $emulator -L '$root' -cpu "\${CPU:-max}" "\$@"
RUN
chmod +x "$folder/run"
echo "$packages" >"$folder/complete"
echo "$folder"
