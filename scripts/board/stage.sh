# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh
#
# What a program needs on a board. Sourced by bundle.sh and stage_program.sh.

fail() { echo "error: $1; $2" >&2; exit 3; }

# of_arch ARCH: sets triplet, machine and loader.
# shellcheck disable=SC2034 # used by who sources this
of_arch() {
  case $1 in
    arm64) triplet=aarch64-linux-gnu machine=aarch64 loader=ld-linux-aarch64.so.1 ;;
    *) triplet=x86_64-linux-gnu machine=x86_64 loader=ld-linux-x86-64.so.2 ;;
  esac
}

needed() { readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }

# collect PROGRAM ROOT TO: every library that is needed, and what those need, without the C library (which is the board's).
collect() {
  for library in $(needed "$1"); do
    case $library in libc.so.* | libm.so.* | libpthread.so.* | libdl.so.* | librt.so.* | "$loader") continue ;; esac
    [ ! -e "$3/$library" ] || continue
    found=""
    for folder in "$2/usr/lib/$triplet" "$2/lib/$triplet"; do [ ! -e "$folder/$library" ] || found=$folder/$library; done
    [ -n "$found" ] || fail "the library $library, which $(basename "$1") needs, is not in $2" "./gridspace arm64 build"
    cp -L "$found" "$3/$library"
    collect "$found" "$2" "$3"
  done
}

# strip_to FILE TO: without symbols where there is a tool for the architecture.
strip_to() { "$triplet-strip" -o "$2" "$1" 2>/dev/null || cp "$1" "$2"; }
