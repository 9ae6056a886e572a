#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs this project's dependencies on Debian or Ubuntu; prints nothing if all are installed. Elsewhere it names them.
#
# Usage: tools/setup.sh [--names[=RELEASE]] [build] [play] [test] [players] [quality] [fuzz] [firmware] [arm64] [kernel] [analysis] [docs] [packages] [study]
#   no part  the first four
#   --names  installs nothing: prints the names on this machine's release, or on debian-12, debian-13, debian-sid, ubuntu-24.04 or fedora
#   build    compiler, meson and the libraries that the plugins use
#   play     GStreamer's plugins that decode, encode and show a film
#   test     further dependencies of the test suite
#   players  gst-play-1.0, GstPlay and Python bindings, for pipelines/ and examples/
#   quality  OpenCV's saliency models, for the comparison, which omits them if they are missing
#   fuzz     clang with libFuzzer, for tests/fuzz
#   analysis valgrind, clang-tidy and cppcheck, for tests/run.sh
#   firmware cross compiler and emulator for the test of the seat sketch, which is skipped without them
#   arm64    cross compiler and emulator for the test of maps on arm64, which is skipped without them
#   docs     gi-docgen, for the API reference
#   packages debhelper and lintian, for tools/packages.sh
#   study    R, which analyzes studies: 300 MB, also for the test suite
#   kernel   a virtual machine for tests/kernel: boards on a real Linux kernel
set -euo pipefail

declare -A packages=(
  [build]="g++ meson ninja-build pkgconf libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev libopencv-core-dev
           libopencv-imgproc-dev libopencv-objdetect-dev libhwy-dev libusb-1.0-0-dev libsdl2-dev libsoup-3.0-dev libx11-dev libxrandr-dev gobject-introspection libgirepository1.0-dev
           libexpected-dev libjson-glib-dev libxml2-dev libcairo2-dev help2man libgtk-4-dev gettext"
  [play]="gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-ugly gstreamer1.0-libav
          gstreamer1.0-x gstreamer1.0-alsa gstreamer1.0-pulseaudio opencv-data"
  [test]="python3 python3-gi gir1.2-gstreamer-1.0 gir1.2-gst-plugins-base-1.0 gir1.2-gst-rtsp-server-1.0 xvfb gstreamer1.0-opencv
          umockdev libumockdev-dev libx11-6 gst123 totem parole clapper gir1.2-gtk-4.0 gir1.2-atspi-2.0 at-spi2-core desktop-file-utils libgtk-4-media-gstreamer gir1.2-webkit2-4.1 iproute2 linuxptp gstreamer1.0-plugins-bad gstreamer1.0-gl libgl1-mesa-dri
          parallel slurmctld slurmd slurm-client munge python3-websockets python3-webvtt python3-aeidon ffmpeg mkvtoolnix dbus-daemon libglib2.0-bin pulseaudio pipewire pipewire-pulse wireplumber mpv vlc-bin vlc-plugin-base vlc-plugin-video-output kodi kodi-bin python3-dbusmock systemd python3-opencv python3-scipy python3-numpy
          clang-format-14 codespell appstream git mandoc libaubio-dev libchromaprint-tools espeak-ng flite asterisk-core-sounds-en-g722 asterisk-core-sounds-es-g722 asterisk-prompt-es-co asterisk-prompt-fr-armelle
          asterisk-prompt-it-menardi-wav pocketsphinx-testdata alsa-utils chromium chromium-driver python3-selenium x11-utils x11-xserver-utils xdotool poppler-utils"
  [players]="gstreamer1.0-plugins-base-apps libgstreamer-plugins-bad1.0-dev python3 python3-gi gir1.2-gstreamer-1.0
             gir1.2-gst-plugins-base-1.0"
  [quality]="libopencv-contrib-dev"
  [fuzz]="clang libclang-rt-14-dev"
  [analysis]="valgrind clang-tidy cppcheck libglib2.0-dev"
  [firmware]="gcc-avr avr-libc arduino-core-avr libsimavr-dev"
  [arm64]="g++-aarch64-linux-gnu qemu-user"
  [docs]="gi-docgen"
  [packages]="dpkg-dev debhelper fakeroot gi-docgen gstreamer1.0-plugins-base lintian git"
  [study]="r-base-core r-cran-afex r-cran-emmeans"
  [kernel]="qemu-system-x86 busybox-static kmod udev"
)

# Where a release has another name than Debian 12, above; "-": no such package. Of Ubuntu's chromium, only a snap is left.
renamed='
  clang-format-14           debian-13=-                  debian-sid=-
  libclang-rt-14-dev        debian-13=libclang-rt-19-dev debian-sid=libclang-rt-dev ubuntu-24.04=libclang-rt-18-dev
  libgtk-4-media-gstreamer                               debian-sid=-
  chromium                                                                          ubuntu-24.04=-
  chromium-driver                                                                   ubuntu-24.04=-
'

# Fedora's names for what a film needs.
declare -A fedora=(
  [build]="gcc-c++ meson ninja-build pkgconf-pkg-config gstreamer1-devel gstreamer1-plugins-base-devel opencv-devel highway-devel libusb1-devel
           SDL2-devel libsoup3-devel libX11-devel libXrandr-devel gobject-introspection-devel expected-devel json-glib-devel libxml2-devel cairo-devel help2man gtk4-devel gettext"
  [play]="gstreamer1 gstreamer1-plugins-base gstreamer1-plugins-good gstreamer1-plugins-ugly-free gstreamer1-plugin-libav opencv-data"
  [players]="gstreamer1-plugins-base-tools gstreamer1-plugins-bad-free-devel python3-gobject"
)

fail() {
  echo "setup.sh: $1" >&2
  exit "${2:-1}"
}

# As in os-release(5): debian-12, debian-sid, ubuntu-24.04, fedora (also what is derived from it).
this_release() {
  local ID='' ID_LIKE='' VERSION_ID=''
  # shellcheck disable=SC1091 # the machine's
  [ ! -r /etc/os-release ] || . /etc/os-release
  case " $ID $ID_LIKE " in
    *" fedora "*) echo fedora ;;
    *) echo "${ID:-unknown}-${VERSION_ID:-sid}" ;;
  esac
}

# names_on RELEASE PART...: one a line
names_on() {
  local release=$1 part name row
  shift
  for part in "$@"; do
    if [ "$release" = fedora ]; then
      # shellcheck disable=SC2086 # a list of words
      printf '%s\n' ${fedora[$part]:-}
      continue
    fi
    for name in ${packages[$part]}; do
      row=
      [[ $renamed != *" $name "* ]] || row=$(sed -n "s/^ *$name .*[[:space:]]$release=\([^ ]*\).*/\1/p" <<<"$renamed")
      [ "$row" = - ] || printf '%s\n' "${row:-$name}"
    done
  done
}

release=$(this_release)
prints_names=
parts=()
for argument in "$@"; do
  case $argument in
    -h | --help) sed -n '3,20s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --names) prints_names=yes ;;
    --names=debian-1[23] | --names=debian-sid | --names=ubuntu-24.04 | --names=fedora) prints_names=yes; release=${argument#--names=} ;;
    --names=*) fail "expected --names=debian-12, debian-13, debian-sid, ubuntu-24.04 or fedora, got '$argument'" 2 ;;
    *)
      if [ -z "$argument" ] || [ -z "${packages[$argument]:-}" ]; then
        fail "expected build, play, test, players, quality, fuzz, firmware, arm64, kernel, analysis, docs, packages or study, got '$argument'; see setup.sh --help" 2
      fi
      parts+=("$argument")
      ;;
  esac
done
[ ${#parts[@]} -gt 0 ] || parts=(build play test players)
mapfile -t wanted < <(names_on "$release" "${parts[@]}")
if [ -n "$prints_names" ]; then
  printf '%s\n' "${wanted[@]}"
  exit 0
fi

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  installs="what these Debian packages hold
with your distribution's package manager"
  [ "$release" != fedora ] || installs="these packages with dnf"
  cat >&2 <<TXT
setup.sh: this is not Debian or Ubuntu, so nothing was installed. Please install $installs,
then set VISUOTACTILE_NO_SETUP=1 and try again:
  ${wanted[*]}
(GStreamer and its base, good, ugly and libav plugins, 1.22 or newer; OpenCV core, imgproc and objdetect 4 and its cascades; Highway 1.0; tl::expected 1.0; libusb 1.0; SDL 2.24; libsoup 3.0; libX11, libXrandr 1.5; meson 1.0; a C++20 compiler; Python's gi)
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
  command -v sudo >/dev/null || fail "these packages are missing and you are neither root nor have sudo. Please install them as root:
  apt-get install ${missing[*]}"
  run=(sudo)
fi

echo "Installing: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

# A lock that another program holds, as a new machine's own updates do for minutes, is waited for. (DPkg::Lock::Timeout is for one of apt's locks,
# and says nothing.)
lock_wait=10 # minutes
apt() {
  local tries=$((lock_wait * 6)) held
  until "${run[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 apt-get -qq -o Dpkg::Use-Pty=0 "$@" >"$log" 2>&1; do
    held=$(grep -m 1 -o 'Could not get lock.*' "$log") || return 1
    [ $((tries -= 1)) -gt 0 ] || { echo "setup.sh: another program still installs packages after $lock_wait minutes" >&2; return 1; }
    [ -n "${has_said:-}" ] || echo "Waiting while another program installs packages: $held"
    has_said=yes
    sleep 10
  done
}

# Those of the names that apt does not know.
unknown_names() {
  local name known
  for name in "$@"; do
    known=$(apt-cache policy "$name" 2>/dev/null | sed -n '/^  Candidate: [^(]/p')
    [ -n "$known" ] || printf '%s ' "$name"
  done
}

give_up() {
  tail -n 20 "$log" >&2
  grep -qE 'Failed to fetch|Temporary failure|Could not (resolve|connect)' "$log" && fail "apt-get could not fetch packages (see above); is this machine online?"
  fail "apt-get could not install them (see above)"
}

apt update || give_up
unknown=$(unknown_names "${missing[@]}")
if [ -n "$unknown" ]; then
  # A fetch that fails is a warning to 'apt-get update', and leaves the lists of packages as they are.
  ! grep -q 'Failed to fetch' "$log" || give_up
  fail "$release has no packages of these names, so nothing was installed: $unknown
Please add this release's names to the table 'renamed' in tools/setup.sh, or install what they hold, set VISUOTACTILE_NO_SETUP=1 and try again."
fi
apt install -y --no-install-recommends "${missing[@]}" || give_up
