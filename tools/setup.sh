#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs this project's dependencies on Debian or Ubuntu; prints nothing if all are installed.
#
# Usage: tools/setup.sh [build] [play] [test] [players] [quality] [fuzz] [firmware] [kernel] [analysis] [docs] [packages]     (no argument: the first four)
#   build    compiler, meson and the libraries that the plugins use
#   play     GStreamer's plugins that decode, encode and show a film
#   test     further dependencies of the test suite
#   players  gst-play-1.0, GstPlay and Python bindings, for pipelines/ and examples/
#   quality  OpenCV's saliency models, for the comparison, which omits them if they are missing
#   fuzz     clang with libFuzzer, for tests/fuzz
#   analysis valgrind, clang-tidy and cppcheck, for tests/run.sh
#   firmware cross compiler and emulator for the test of the seat sketch, which is skipped without them
#   docs     gi-docgen, for the API reference
#   packages debhelper and lintian, for tools/packages.sh
#   kernel   a virtual machine for tests/kernel: boards on a real Linux kernel
set -euo pipefail

declare -A packages=(
  [build]="g++ meson ninja-build pkg-config libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev libopencv-core-dev
           libopencv-imgproc-dev libopencv-objdetect-dev libhwy-dev libusb-1.0-0-dev libsdl2-dev libsoup-3.0-dev gobject-introspection libgirepository1.0-dev
           libexpected-dev libjson-glib-dev libxml2-dev libcairo2-dev help2man"
  [play]="gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-ugly gstreamer1.0-libav
          gstreamer1.0-x gstreamer1.0-alsa gstreamer1.0-pulseaudio opencv-data"
  [test]="python3 python3-gi gir1.2-gstreamer-1.0 gir1.2-gst-plugins-base-1.0 gir1.2-gst-rtsp-server-1.0 xvfb gstreamer1.0-opencv
          umockdev libumockdev-dev libx11-6 gst123 totem parole clapper gir1.2-gtk-4.0 libgtk-4-media-gstreamer gir1.2-webkit2-4.1 iproute2 linuxptp gstreamer1.0-plugins-bad gstreamer1.0-gl libgl1-mesa-dri
          parallel python3-websockets python3-webvtt python3-aeidon ffmpeg mkvtoolnix dbus-daemon libglib2.0-bin pulseaudio pipewire pipewire-pulse wireplumber mpv vlc-bin vlc-plugin-base vlc-plugin-video-output kodi kodi-bin python3-dbusmock systemd python3-opencv python3-scipy python3-numpy
          clang-format-14 codespell git mandoc libaubio-dev espeak-ng flite asterisk-core-sounds-en-g722 asterisk-core-sounds-es-g722 asterisk-prompt-es-co asterisk-prompt-fr-armelle
          asterisk-prompt-it-menardi-wav pocketsphinx-testdata alsa-utils libsoup2.4-1 chromium chromium-driver python3-selenium"
  [players]="gstreamer1.0-plugins-base-apps libgstreamer-plugins-bad1.0-dev python3 python3-gi gir1.2-gstreamer-1.0
             gir1.2-gst-plugins-base-1.0"
  [quality]="libopencv-contrib-dev"
  [fuzz]="clang libclang-rt-14-dev"
  [analysis]="valgrind clang-tidy cppcheck libglib2.0-dev"
  [firmware]="gcc-avr avr-libc arduino-core-avr libsimavr-dev"
  [docs]="gi-docgen"
  [packages]="dpkg-dev debhelper fakeroot gi-docgen lintian git"
  [kernel]="qemu-system-x86 busybox-static kmod udev"
)

usage() {
  sed -n '3,16s/^# \{0,1\}//p' "$0"
}

parts=("$@")
[ $# -gt 0 ] || parts=(build play test players)
wanted=()
for part in "${parts[@]}"; do
  case $part in
    -h | --help) usage; exit 0 ;;
    build | play | test | players | quality | fuzz | firmware | kernel | analysis | docs | packages) read -r -d '' -a names <<<"${packages[$part]}" || true; wanted+=("${names[@]}") ;;
    *) echo "setup.sh: expected build, play, test, players, quality, fuzz, firmware, kernel, analysis, docs or packages, got '$part'; see setup.sh --help" >&2; exit 2 ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  cat >&2 <<TXT
setup.sh: this is not Debian or Ubuntu, so nothing was installed. Please install what these Debian packages hold
with your distribution's package manager, then set VISUOTACTILE_NO_SETUP=1 and try again:
  ${wanted[*]}
(GStreamer and its base, good, ugly and libav plugins, 1.22 or newer; OpenCV core, imgproc and objdetect 4 and its cascades; Highway 1.0; tl::expected 1.0; libusb 1.0; SDL 2.24; libsoup 3.0; meson 1.0; a C++20 compiler; Python's gi)
TXT
  exit 1
fi

missing=()
for name in "${wanted[@]}"; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$name")
done
[ ${#missing[@]} -gt 0 ] || exit 0

run=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    printf 'setup.sh: these packages are missing and you are neither root nor have sudo. Please install them as root:\n  apt-get install %s\n' \
      "${missing[*]}" >&2
    exit 1
  fi
  run=(sudo)
fi

echo "Installing: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DEBIAN_FRONTEND=noninteractive
apt() {
  "${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1
}
if ! { apt update && apt install -y --no-install-recommends "${missing[@]}"; }; then
  tail -n 20 "$log" >&2
  echo "setup.sh: apt-get could not install them (see above); is this machine online?" >&2
  exit 1
fi
