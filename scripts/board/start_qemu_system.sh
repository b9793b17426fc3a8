#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# Starts a process of a scenario on an emulated ARM64 board (used by `gridspace run` for `run_on: qemu-system`):
#   start_qemu_system.sh IMAGE CONFIG NAME,MAC,ADDRESS|- ... -- PROGRAM ARGUMENT...
# Runs in the network namespace of the scenario's host, whose interfaces it hands over to the board: a bridge and a tap each.
# Status lines leave on descriptor 3, the board's console on standard output. The board's files are the image's, CONFIG, and
# every file that CONFIG names, at the same place.
set -eu
PATH=$PATH:/usr/sbin:/sbin
image=$1 config=$2
shift 2
fail() { # MESSAGE REMEDY
  echo "$1; $2" >&2
  printf '{"status":"failed","code":3,"message":"%s","remedy":"%s"}\n' "$1" "$2" >&3
  exit 3
}
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir "$stage/gridspace"
: >"$stage/gridspace/network"
n=0
devices=""
while [ "$1" != -- ]; do
  name=${1%%,*} rest=${1#*,}
  mac=${rest%%,*} address=${rest#*,}
  shift
  echo "$name $mac $address" >>"$stage/gridspace/network"
  for old in "bb$n" "tap$n"; do ip link del "$old" 2>/dev/null || true; done # of the board before a restart
  {
    ip addr flush dev "$name" &&
      ip link set "$name" down && ip link set "$name" address "06:${mac#*:}" &&
      ip link add "bb$n" type bridge mcast_snooping 0 stp_state 0 &&
      ip tuntap add "tap$n" mode tap && ip link set "tap$n" master "bb$n" up &&
      ip link set "$name" master "bb$n" up && ip link set "bb$n" up
  } 2>"$stage/errors" || { cat "$stage/errors" >&2; fail "the board cannot be plugged into $name" "run_on: qemu-system needs root and /dev/net/tun"; }
  # ctrl_vlan=off: the device would drop what carries a VLAN tag, SMV and GOOSE with their priority that is.
  devices="$devices -netdev tap,id=net$n,ifname=tap$n,script=no,downscript=no -device virtio-net-pci,netdev=net$n,mac=$mac,romfile=,ctrl_vlan=off"
  n=$((n + 1))
done
shift
for word in "/bin/$1" "$@"; do printf '%s\n' "$word"; done | sed 2d >"$stage/gridspace/command"
env | grep '^GRIDSPACE_' >"$stage/gridspace/environment" || true
for file in "$config" $(grep -oE '/[^] ",}]+' "$config" | tr -d "'" | sort -u); do
  if [ -f "$file" ]; then
    mkdir -p "$stage$(dirname "$file")"
    cp "$file" "$stage$file"
  fi
done
{
  cat "$image/initramfs"
  (cd "$stage" && find . | cpio --quiet -o -H newc)
} >"$stage.initrd"
exec 5<"$stage.initrd"
rm -rf "$stage" "$stage.initrd"
trap - EXIT
# shellcheck disable=SC2086 # a list of options
exec qemu-system-aarch64 -M virt -cpu cortex-a53 -smp 1 -m 384 -nodefaults -display none -no-reboot \
  -kernel "$image/vmlinuz" -initrd /dev/fd/5 -append "quiet loglevel=3 console=ttyAMA0 panic=-1 ipv6.disable=1" \
  -chardev stdio,id=console,signal=off -serial chardev:console \
  -device virtio-serial-pci -chardev file,id=status,path=/dev/fd/3 -device virtserialport,chardev=status,name=gridspace.status \
  $devices
