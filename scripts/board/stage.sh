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

# depends_of PROGRAM...: the Debian packages that they link to, as a field `Depends`.
depends_of() (
  depends=""
  for library in $(for file in "$@"; do needed "$file"; done | awk '!seen[$0]++'); do
    case $library in
      libc.so.6 | libm.so.6) package="libc6 (>= 2.36)" ;;
      libgcc_s.so.1) package=libgcc-s1 ;;
      libstdc++.so.6) package="libstdc++6 (>= 12)" ;;
      libfastrtps.so.2.9) package=libfastrtps2.9 ;;
      libfastcdr.so.1) package=libfastcdr1 ;;
      libyaml-cpp.so.0.7) package=libyaml-cpp0.7 ;;
      libfmt.so.9) package=libfmt9 ;;
      libcrypto.so.3 | libssl.so.3) package=libssl3 ;;
      libzstd.so.1) package=libzstd1 ;;
      libz.so.1) package=zlib1g ;;
      libtinyxml2.so.9) package=libtinyxml2-9 ;;
      "$loader") continue ;;
      *) fail "no Debian package is known for the library $library" "add it to scripts/board/stage.sh" ;;
    esac
    case ", $depends," in *", $package,"*) ;; *) depends="$depends${depends:+, }$package" ;; esac
  done
  printf '%s' "$depends"
)

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
