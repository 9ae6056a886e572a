#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Tries this checkout's commits on a bare machine of another release: a chroot with nothing but Debian's required packages. Prints a row of a table for
# each step that is asked for, with its seconds of wall time; the log of each step is in the folder of the machine.
#
# Usage: tests/machines/run.sh [--steps=LIST] [--keep] [--ccache=FOLDER] [--tests=ARGUMENTS] [debian-12 | debian-13 | sid] [amd64 | arm64]
#                                                                                     (default: this machine's; as root)
#        tests/machines/run.sh --table      what all runs showed last: docs/measured/machines.md
#   LIST of  set-up    what the README's two commands install
#            build     the target 'play'
#            film      pipelines/play.sh, the first film, without a window
#            tests     tests/run.sh
#            packages  tools/packages.sh; then on another bare machine, with Depends alone and as a user who is not root: all of
#                      debian/tests
#   Default: set-up,build,film,packages.
#   arm64 on a PC is cross-compiled: set-up; build, of libraries and plugins, whose maps are compared by maps.sh; film, by qemu.
#   --keep    goes on with the machine that the last run left, and with this checkout's commits
#   --ccache  with a compiler cache, which is kept in FOLDER
#   --tests   ARGUMENTS of tests/run.sh, for some tests
# Expects debootstrap. It keeps the bare machine as an archive in the user's cache, $VISUOTACTILE_MACHINES if that is set, and the rows beside it.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
steps=set-up,build,film,packages
cache=${VISUOTACTILE_MACHINES:-${XDG_CACHE_HOME:-$HOME/.cache}/visuotactile/machines}
keep=
compiled=
tests=
fail() {
  echo "run.sh: $1" >&2
  exit 1
}
# What the last run of each step on each machine left in $cache/rows: a file with its result, its time and its commit.
table() {
  local machine architecture step row
  cat <<'PAGE'
# Machines

Made by `tests/machines/run.sh --table` of runs for each row; cells that tell of parts, and the rows of sid and arm64, are by hand.

Bare chroots on one PC of two processors, which other programs used at the same time (load 10 to 18): times are
of the wall and say little. arm64 is cross-compiled and emulated. –: not run.

- set-up: `tools/setup.sh`; the compiler. build: the target `play`; warnings of this project's files.
- film: `pipelines/play.sh`; commands to motors. tests: `tests/run.sh`.
- packages: `tools/packages.sh` and lintian. installed: on another bare machine, without recommended packages, not as
  root.

PAGE
  echo "| machine | set-up | build | film | tests | packages | installed |"
  echo "|---|---|---|---|---|---|---|"
  for machine in debian-12 debian-13 sid; do
    for architecture in amd64 arm64; do
      row=
      for step in set-up build film tests packages installed; do
        row+=" $(cat "$cache/rows/$machine-$architecture-$step" 2>/dev/null || echo "–") |"
      done
      [ -z "${row//[ –|]/}" ] || echo "| $machine $architecture |$row"
    done
  done
}
while :; do
  case ${1:-} in
    -h | --help) sed -n '3,23s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --steps=*) steps=${1#--steps=} ;;
    --keep) keep=yes ;;
    --ccache=*) mkdir -p "${1#--ccache=}"; compiled=$(cd "${1#--ccache=}" && pwd) ;;
    --tests=*) tests=${1#--tests=} ;;
    --table) table; exit 0 ;;
    -*) fail "expected --steps=LIST, --keep, --ccache=FOLDER, --tests=ARGUMENTS or --table, got '$1'; see run.sh --help" ;;
    *) break ;;
  esac
  shift
done
# shellcheck disable=SC1091 # the machine's
release=${1:-$(. /etc/os-release && echo "$ID-${VERSION_ID:-sid}")}
own=$(dpkg --print-architecture)
architecture=${2:-$own}
case $release in
  debian-12) suite=bookworm ;;
  debian-13) suite=trixie ;;
  sid | debian-sid) suite=sid ;;
  *) fail "expected debian-12, debian-13 or sid, got '$release'" ;;
esac
case $own-$architecture in
  amd64-amd64 | arm64-arm64) cross= ;;
  amd64-arm64) cross=yes ;;
  *) fail "expected amd64 or arm64 (amd64 only on a PC), got '$architecture'" ;;
esac
[ "$(id -u)" -eq 0 ] || fail "expected root, who makes chroots"
command -v debootstrap >/dev/null || fail "there is no debootstrap: apt-get install debootstrap"

bare=$cache/$suite-$own.tar
machine=$cache/$suite-$architecture-machine
mkdir -p "$cache/rows"
exec 9>"$machine.lock"
flock 9
if [ ! -f "$bare" ]; then
  rm -rf "$machine"
  debootstrap --variant=minbase --include=ca-certificates "$suite" "$machine" >"$cache/$suite.log" 2>&1 ||
    { tail -n 5 "$cache/$suite.log" >&2; fail "debootstrap could not make the machine; all of it is in $cache/$suite.log"; }
  tar -c -C "$machine" -f "$bare.part" .
  mv "$bare.part" "$bare"
fi

# in_machine FOLDER COMMAND...: its mounts and processes end with it
in_machine() {
  local folder=$1
  shift
  # shellcheck disable=SC2016 # the inner shell's
  unshare --mount --pid --fork bash -c '
    mount --bind "$0" "$0" # ip netns expects that / is a mount
    cd "$0"
    for name in dev sys; do mount --rbind /$name "$0/$name"; done
    mount -t proc proc "$0/proc"
    mount -t tmpfs tmpfs "$0/tmp"
    [ -z "$2" ] || { mkdir -p "$0/ccache"; mount --bind "$2" "$0/ccache"; }
    folder=$0
    exec chroot "$folder" /usr/bin/env -i HOME=/root ${2:+CCACHE_DIR=/ccache CCACHE_COMPILERCHECK=content} PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM=dumb \
      ${http_proxy:+http_proxy=$http_proxy} ${https_proxy:+https_proxy=$https_proxy} DEBIAN_FRONTEND=noninteractive bash -o pipefail -ec "$1"
  ' "$folder" "$1" "$compiled" </dev/null
}
make_machine() {
  rm -rf "$1"
  mkdir -p "$1"
  tar -x -C "$1" -f "$bare"
  echo force-unsafe-io >"$1/etc/dpkg/dpkg.cfg.d/unsafe-io"
  cp /etc/resolv.conf "$1/etc/"
  # It downloads by the same proxy, and is as strict about dates.
  apt-config dump | grep -E '^Acquire::(Check-|https?::)' >"$1/etc/apt/apt.conf.d/90machine" || true
}
[ -n "$keep" ] || rm -rf "$machine"
[ -d "$machine/visuotactile" ] || make_machine "$machine"
# Root may run this in a user's checkout.
git=(git -c safe.directory="$root" -C "$root")
"${git[@]}" bundle create -q "$machine/commits" HEAD
if [ -d "$machine/visuotactile" ]; then
  git -C "$machine/visuotactile" fetch -q "$machine/commits" HEAD
  git -C "$machine/visuotactile" -c advice.detachedHead=false checkout -q FETCH_HEAD
else
  git -c advice.detachedHead=false clone -q "$machine/commits" "$machine/visuotactile"
fi
commit=$("${git[@]}" rev-parse --short HEAD)

status=0
broken=
# step NAME COMMAND: a row with what the command prints last, as the result
step() {
  local name=$1 command=$2 log=$cache/$suite-$architecture-$1.log since=$SECONDS result=yes
  [[ ,$steps, == *,$name,* ]] || return 0
  if [ -n "$broken" ]; then
    result="not tried"
  elif in_machine "$machine" "cd /visuotactile; $command" >"$log" 2>&1; then
    result=$(grep -aE '^[0-9]+ passed, |^result: ' "$log" | tail -n 1)
    result=${result#result: }
  else
    result="**no**: $(grep -a . "$log" | tail -n 1 | cut -c 1-120)"
    [[ $name == tests || $name == packages ]] || broken=yes
    status=1
  fi
  echo "| $release | $architecture | $name | ${result:-yes} | $((SECONDS - since)) s |"
  [[ -n $tests && $name == tests ]] || echo "${result:-yes}, $((SECONDS - since)) s${compiled:+ (ccache)}, $commit" >"$cache/rows/$release-$architecture-$name"
}
echo "| machine | architecture | step | result | time |"
echo "|---|---|---|---|---|"
if [ -n "$cross" ]; then
  step set-up "${compiled:+apt-get -qq update; apt-get -qq install -y ccache;}"'apt-get -qq update; tools/setup.sh build arm64; apt-get -qq install -y ffmpeg; tests/machines/target.sh; aarch64-linux-gnu-gcc --version | sed -n "s/^\(aarch64\)/result: \1/p"'
  step build 'meson setup build --auto-features=disabled -Dsaliency=enabled; ninja -C build tests/maps
    tests/machines/maps.sh . build all; f=build/machines/arm64-all/gst/saliency/libgstsaliency.so; file=$(readelf -h $f | sed -n "s/ *Machine: *//p"); echo "result: $file"'
  step film 'run=$(tests/machines/target.sh)/run; target=${run%/run}/root/usr; all=build/machines/arm64-all
    $run -E LD_LIBRARY_PATH=$PWD/$all/lib/gst/tactile -E GST_REGISTRY_FORK=no -E GST_REGISTRY_1_0=/tmp/registry -E GST_PLUGIN_SYSTEM_PATH_1_0=$target/lib/aarch64-linux-gnu/gstreamer-1.0 \
      -E GST_PLUGIN_PATH_1_0=$PWD/$all/gst $target/bin/gst-launch-1.0 -q tactiletestsrc num-buffers=50 ! saliencytactile ! tactorsink driver=simulator sync=false trace-location=/tmp/trace.csv
    echo "result: $(sed 1d /tmp/trace.csv | wc -l) commands"'
else
  parts="build play"
  [[ ,$steps, != *,tests,* ]] || parts+=" test players docs study"
  step set-up "${compiled:+apt-get -qq update; apt-get -qq install -y ccache;} tools/setup.sh $parts; "'g++ --version | sed -n "1s/^/result: /p"'
  step build 'meson setup build; ninja -C build play | tee /tmp/log; echo "result: $(grep -c warning: /tmp/log || true) warnings"'
  step film 'export XDG_RUNTIME_DIR=/tmp; GST_PLUGIN_PATH=$PWD/build/gst gst-launch-1.0 -q tactiletestsrc num-buffers=90 ! videoconvert ! vp8enc deadline=1 ! webmmux ! filesink location=/tmp/film.webm
    VISUOTACTILE_NO_SETUP=1 pipelines/play.sh --no-window --output=/tmp/played /tmp/film.webm; n=$(sed 1d /tmp/played/commands.csv | wc -l); [ "$n" -gt 0 ]; echo "result: $n commands"'
  step tests "tests/run.sh $tests"
  step packages 'tools/setup.sh build packages; lintian --version; tools/packages.sh /packages; echo "result: $(ls /packages/*.deb | wc -l) packages, lintian silent"'
  if [[ ,$steps, == *,packages,* ]] && ls "$machine"/packages/*.deb >/dev/null 2>&1; then
    built=$machine
    machine=$cache/$suite-$architecture-bare
    make_machine "$machine"
    cp -r "$built/packages" "$machine/packages"
    mkdir "$machine/visuotactile"
    cp -r "$built/visuotactile/debian" "$machine/visuotactile"
    steps=$steps,installed
    # As debian/tests/control has it, without Recommends.
    step installed 'apt-get -qq update; cd /packages; apt-get -qq install -y --no-install-recommends ./*.deb gstreamer1.0-tools gstreamer1.0-plugins-good python3-gi build-essential pkgconf >/dev/null
      useradd -m maker
      for test in film python application people gamepad websocket; do
        mkdir -m 777 /tmp/$test; cp /visuotactile/debian/tests/$test /tmp/$test.sh; chmod 755 /tmp/$test.sh
        runuser -u maker -- env HOME=/home/maker AUTOPKGTEST_TMP=/tmp/$test /tmp/$test.sh || { echo "$test failed"; exit 1; }
      done
      apt-get -qq purge -y "*visuotactile*" "*gsttactile*" >/dev/null
      if find / -xdev -name "*visuotactile*" -not -path "/visuotactile*" -not -path "/packages/*" -not -path "/proc/*" -not -path "/tmp/*" | grep .; then
        echo "purge left the files above"; exit 1
      fi
      echo "result: film, python, application, people, gamepad, websocket passed; purged without a rest"'
  fi
fi
exit $status
