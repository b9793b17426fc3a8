#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# Makes the image of the guest: make_image.sh [FOLDER], by default `image` next to this file. Debian's kernel for virtual machines (a download
# of 25 MB, once for a user, not installed), and an initramfs of the drivers of its network card and the relay. Without root, on Debian for amd64.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
image=${1:-$here/image}
# shellcheck source=scripts/cache.sh
source "$here/../../scripts/cache.sh"
fail() {
  echo "make_image.sh: $*" >&2
  exit 3
}
for tool in cc cpio apt-get dpkg-deb; do
  command -v "$tool" >/dev/null || fail "'$tool' is missing: apt install gcc libc6-dev cpio"
done

modules="failover net_failover virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci virtio_net" # in the order of loading
package=$(apt-cache depends linux-image-cloud-amd64 2>/dev/null | sed -n 's/^ *Depends: \(linux-image-[0-9].*\)/\1/p')
[ -n "$package" ] || fail "apt knows no linux-image-cloud-amd64: is this Debian for amd64, and was there an apt-get update?"
kernel_into() {
  (cd "$1" && apt-get download -qq -o APT::Sandbox::User="$(id -un)" "$package" && dpkg-deb -x ./*.deb tree && cp tree/boot/vmlinuz-* vmlinuz) || return
  for module in $modules; do
    find "$1/tree" -name "$module.ko" -exec cp {} "$1/" \;
  done
  rm -rf "$1/tree" "$1"/*.deb
}
kernel=$(gridspace_cache)/guest/$package
cached "$kernel" kernel_into || fail "no kernel from the package $package"

stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir -p "$image" "$stage/modules"
n=0
for module in $modules; do
  cp "$kernel/$module.ko" "$stage/modules/$(printf %02d "$n").ko" || fail "$package has no driver $module"
  n=$((n + 1))
done
cc -std=gnu17 -O2 -Wall -Wextra -Werror -static -s -o "$stage/init" "$here/relay.c" -lm
(cd "$stage" && find . | LC_ALL=C sort | cpio --quiet -o -H newc -R 0:0) | gzip -n >"$image/initramfs"
cp "$stage/init" "$image/relay" # for a container
cp "$kernel/vmlinuz" "$image/"
echo "$image: $(du -h "$image/vmlinuz" | cut -f1) kernel, $(du -h "$image/initramfs" | cut -f1) of drivers and relay"
