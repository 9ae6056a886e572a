#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes a folder with the libraries of another machine. It needs no root: nothing is installed here, and this machine's dpkg learns of no other
# architecture. Prints the folder, in which are
#   root/      what Debian's packages hold
#   run        runs a program: of arm64 in an emulator, where $CPU is one of qemu's instead of its fullest; of amd64 with the libraries of root/,
#              and with those of this machine that are not there
#   meson.ini  of arm64: the cross file
#
# Usage: tests/machines/target.sh [arm64|arm64-tests|amd64 [RELEASE [FOLDER]]]      (default: arm64, this machine's release, a folder in the user's cache)
#   arm64-tests  what the tests of libraries and elements need, too: see elements.sh
#
# For arm64 it expects what `tools/setup.sh arm64` installs. Does nothing if the folder is complete.
set -euo pipefail
case ${1:-} in
  -h | --help) sed -n '3,13s/^# \{0,1\}//p' "$0"; exit 0 ;;
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
case $architecture in
  arm64 | arm64-tests)
    triplet=aarch64-linux-gnu
    emulator=qemu-aarch64
    for program in $triplet-g++ $emulator; do
      command -v "$program" >/dev/null || fail "there is no $program: run tools/setup.sh arm64"
    done
    # What the plugins are built with, but for modules, which need four times as much; and what plays films to them.
    packages="libc6-dev libstdc++-$($triplet-gcc -dumpversion)-dev libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev libopencv-core-dev libopencv-imgproc-dev
      libhwy-dev libexpected-dev libusb-1.0-0-dev libjson-glib-dev libxml2-dev gstreamer1.0-tools gstreamer1.0-plugins-base"
    [ "$architecture" = arm64 ] || packages+=" libopencv-objdetect-dev libsdl2-dev libsoup-3.0-dev libaubio-dev libcairo2-dev libumockdev-dev libudev-dev
      libgstreamer-plugins-bad1.0-dev gstreamer1.0-plugins-good gstreamer1.0-plugins-bad gstreamer1.0-plugins-ugly gstreamer1.0-libav gstreamer1.0-gl
      gstreamer1.0-opencv"
    ;;
  amd64)
    triplet=x86_64-linux-gnu
    # GStreamer and what tests play with it; the plugins' other libraries are this machine's.
    packages="gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-bad gstreamer1.0-plugins-ugly
      gstreamer1.0-libav gstreamer1.0-gl gstreamer1.0-x libsdl2-2.0-0"
    ;;
  *) fail "expected arm64, arm64-tests or amd64, got '$architecture'" ;;
esac
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

# An apt of the folder's own, which downloads from where this machine's does, by the same proxy, and is as strict about dates.
# shellcheck disable=SC2016 # apt's field
mirror=$(apt-get indextargets --no-release-info --format '$(REPO_URI)' 'Created-By: Packages' "Release: $here" | sed -n 1p)
[ -n "$mirror" ] || fail "apt has no source of Debian's packages for '$here'"
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $release main" >"$folder/apt/etc/sources.list"
touch "$folder/apt/status"
apt-config dump | grep -E '^Acquire::(Check-|https?::)' >"$folder/apt/apt.conf" || true
cat >>"$folder/apt/apt.conf" <<CONF
Dir::Etc "$folder/apt/etc";
Dir::State "$folder/apt";
Dir::State::status "$folder/apt/status";
Dir::State::lists "$folder/apt/lists";
Dir::Cache "$folder/apt";
Dir::Cache::archives "$folder/apt/archives";
APT::Architecture "${architecture%-*}";
APT::Architectures { "${architecture%-*}"; };
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
# From Debian 13 on, no package has a file outside /usr.
for name in lib lib64; do
  [ -e "$root/$name" ] || ln -s "usr/$name" "$root/$name"
done

# Links to absolute paths are within the folder.
find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
  ln -sfnr "$root$target" "$link"
done

if [ "$triplet" = aarch64-linux-gnu ]; then
  # Links that the packages' own scripts would make.
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
exe_wrapper = '$folder/run'

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
else
  lib=$root/usr/lib/$triplet
  cat >"$folder/run" <<RUN
#!/bin/sh
export GST_PLUGIN_SYSTEM_PATH_1_0='$lib/gstreamer-1.0' GST_REGISTRY_FORK=no GIO_MODULE_DIR=/nowhere
exec '$lib/ld-linux-x86-64.so.2' --library-path "\${LD_LIBRARY_PATH:+\$LD_LIBRARY_PATH:}$lib:$lib/pulseaudio:$lib/blas:$lib/lapack" "\$@"
RUN
fi
chmod +x "$folder/run"
echo "$packages" >"$folder/complete"
echo "$folder"
