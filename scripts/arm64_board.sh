# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# shellcheck disable=SC2154 # root
# The image of the emulated ARM64 board: Debian's cloud kernel, and in its initramfs busybox, our programs and their libraries.
# Sourced by scripts/arm64.sh, which sets `root`.

board=$root/build/arm64-board

# Everything that our programs link to, with what that needs.
board_packages="busybox-static libfastrtps2.9 libfastcdr1 libyaml-cpp0.7 libfmt9 libstdc++6 libtinyxml2-9 libssl3 libzstd1 zlib1g"

# In the order in which they have to be loaded.
board_modules="failover net_failover virtio_ring virtio virtio_pci_modern_dev virtio_pci_legacy_dev virtio_pci virtio_net virtio_console"

# make_board_image: build/arm64-board/{vmlinuz,initramfs}, made again when a program is newer.
make_board_image() {
  # shellcheck disable=SC2086 # a list of names
  arm64_unpack "$board/root" $board_packages && arm64_unpack "$board/kernel" linux-image-cloud-arm64 || return
  local image=$board/initramfs stage module file
  if [ -f "$image" ] && [ ! "$(readlink -f "$board/root")" -nt "$image" ] && [ -z "$(find "$root/build/arm64/bin" "$root/scripts/board" "$root/scripts/arm64_board.sh" -newer "$image" -print -quit)" ]; then return 0; fi
  stage=$(mktemp -d "$root/build/board.XXXX")
  mkdir -p "$stage"/{bin,dev,proc,sys,tmp,run,gridspace,usr/lib/modules} && ln -s usr/lib "$stage/lib"
  cp -a "$board/root/usr/lib/aarch64-linux-gnu" "$stage/usr/lib/" && rm -rf "$stage/usr/lib/aarch64-linux-gnu"/{gconv,perl*,engines-3,ossl-modules}
  ln -s aarch64-linux-gnu/ld-linux-aarch64.so.1 "$stage/usr/lib/ld-linux-aarch64.so.1"
  cp "$board/root/bin/busybox" "$stage/bin/"
  for module in $board_modules; do
    file=$(find "$board/kernel/usr/lib/modules" -name "$module.ko" | head -n 1)
    [ -n "$file" ] || { say "Debian's cloud kernel has no module $module"; return 3; }
    cp "$file" "$stage/usr/lib/modules/" && echo "$module" >>"$stage/usr/lib/modules/order"
  done
  for file in "$root"/build/arm64/bin/gridspace-*; do
    aarch64-linux-gnu-strip -o "$stage/bin/$(basename "$file")" "$file" || return
  done
  cp "$root/scripts/board/init" "$stage/init"
  (cd "$stage" && find . | cpio --quiet -o -H newc -R 0:0) >"$image.new" || return
  rm -rf "$stage"
  cp "$root/scripts/board/start_qemu_system.sh" "$board/" && cp "$board"/kernel/boot/vmlinuz-* "$board/vmlinuz" && mv "$image.new" "$image" || return
  say "made the board's image: kernel $(du -h "$board/vmlinuz" | cut -f1), root $(du -h "$image" | cut -f1)"
}
