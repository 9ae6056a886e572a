#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Tactor boards on a real kernel: Debian's, in a virtual machine, with its cdc_acm, ftdi_sio and ch341, and boards plugged into its vhci_hcd.
# Tests what the kernel's drivers do to a released board (baud rate, DTR), and who has a port open.
#
# Usage: tests/kernel/run.sh [BUILD] [CASE ...]      BUILD: a build folder, default build; CASE: see drivers.py, default all
# Needs tools/setup.sh kernel, but neither root nor KVM. The machine's clock counts instructions (qemu -icount), independent of the host's speed.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
case ${1:-} in -h | --help) sed -n '3,8s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
build=$(realpath "${1:-$root/build}")
shift || true
[ -f "$build/build.ninja" ] || { echo "run.sh: expected a build folder, got '$build'; build with tests/run.sh first" >&2; exit 2; }
PATH=$PATH:/usr/sbin
for program in qemu-system-x86_64 busybox modprobe; do
  command -v "$program" >/dev/null || { echo "run.sh: $program is missing; run tools/setup.sh kernel" >&2; exit 1; }
done
here=$build/kernel
mkdir -p "$here"
cd "$here"

# Unpacks Debian's kernel without installing it.
if [ ! -d image ]; then
  package=$(apt-cache depends linux-image-amd64 | sed -n 's/^ *Depends: //p')
  apt-get -qq download "$package"
  dpkg-deb -x "$package"_*.deb unpacked
  rm "$package"_*.deb
  mv unpacked image
fi
version=$(ls image/lib/modules)
[ -f "image/lib/modules/$version/modules.dep" ] || depmod -b image "$version"

rm -rf initramfs
mkdir -p initramfs/{bin,modules,proc,sys,dev,host,layer,root}
cp "$(command -v busybox)" initramfs/bin/
for module in virtio_pci 9pnet_virtio 9p overlay vhci-hcd cdc-acm ftdi_sio ch341; do
  modprobe -d image -S "$version" --show-depends "$module"
done | awk '$1 == "insmod" && !seen[$2]++ { print $2 }' >modules
xargs -a modules cp -t initramfs/modules
sed 's|.*/||' modules >initramfs/modules/order
printf '%q ' env "BUILD=$build" "TESTS=$root/tests/kernel" /usr/bin/python3 "$root/tests/kernel/drivers.py" "$@" >initramfs/command
cat >initramfs/init <<'INIT'
#!/bin/busybox sh
b=/bin/busybox
$b mount -t proc none /proc; $b mount -t sysfs none /sys; $b mount -t devtmpfs none /dev
for module in $($b cat /modules/order); do $b insmod "/modules/$module"; done
# The host's files, read-only.
$b mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose host /host
$b mount -t tmpfs none /layer; $b mkdir /layer/upper /layer/work
$b mount -t overlay -o lowerdir=/host,upperdir=/layer/upper,workdir=/layer/work none /root
for folder in proc sys dev; do $b mount --bind /$folder /root/$folder; done
$b mkdir -p /root/dev/pts; $b mount -t devpts -o ptmxmode=666 none /root/dev/pts
$b mount -t tmpfs none /root/run; $b mount -t tmpfs none /root/tmp
$b ip link set lo up
$b cp /command /root/tmp/command
$b chroot /root /bin/sh -c '/lib/systemd/systemd-udevd --daemon; . /tmp/command'
$b poweroff -f
INIT
chmod +x initramfs/init
(cd initramfs && find . | busybox cpio -o -H newc 2>/dev/null | gzip -1) >initramfs.gz

status=0
timeout --foreground 3600 qemu-system-x86_64 -accel tcg,thread=single -icount shift=1,sleep=off -cpu max -smp 1 -m 1024 -nographic -no-reboot \
  -kernel "image/boot/vmlinuz-$version" -initrd initramfs.gz -append "console=ttyS0 quiet loglevel=0 panic=-1" \
  -virtfs local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap </dev/null 2>&1 |
  stdbuf -oL tr -d '\r' | tee log | sed -un '/^[ 0-9.]*\(case\|ok\|FAIL\|     \|[0-9]* passed\)/p' || status=$?
grep -q '^[1-9][0-9]* passed, 0 failed$' log || { status=1; echo "run.sh: not all passed; everything the machine printed is in $here/log" >&2; }
exit "$status"
