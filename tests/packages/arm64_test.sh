#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# tests/packages/arm64_test.sh [FOLDER OF PACKAGES]: the packages for ARM64 (`./gridspace package --arch arm64`) are what Debian expects of
# packages (lintian), apt finds all they depend on in Debian 12 of ARM64, and what is in them runs there under qemu-user: merging units,
# relay and breaker IED of case study 2 give the same recording as those of this machine. As root; needs mmdebstrap, qemu-user-static,
# a network, and what `./gridspace build` and `./gridspace arm64 build` make.
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
# shellcheck source=scripts/cache.sh
source "$root/scripts/cache.sh"
packages=$(readlink -f "${1:-$root/build/packages}")
gridspace=$root/build/release/bin/gridspace
names=(gridspace-agents libgridspace1 libgridspace-dev)
[ "$(id -u)" -eq 0 ] || { echo "run this as root: it makes a chroot" >&2; exit 3; }
shopt -s nullglob
debs=("$packages"/*_arm64.deb)
[ "${#debs[@]}" -eq "${#names[@]}" ] || { echo "there are ${#debs[@]} packages for arm64 in $packages, and not ${#names[@]}: ./gridspace package --arch arm64" >&2; exit 2; }

passed=0
ok() { passed=$((passed + 1)); printf '%s ok   %s\n' "$(date -u +%T)" "$1"; }
work=$(mktemp -d /var/tmp/gridspace_arm64_packages.XXXXXX)
trap 'rm -rf --one-file-system "$work"' EXIT

lintian --allow-root --fail-on error,warning "${debs[@]}"
ok "lintian has nothing to say"

mkdir "$work/archive" && cp "${debs[@]}" "$work/archive/"
(cd "$work/archive" && dpkg-scanpackages -m . >Packages 2>/dev/null)
mmdebstrap --quiet --architectures=arm64 --variant=extract --include="$(IFS=,; echo "${names[*]}")" bookworm "$work/tree" \
  "deb $(debian_mirror) bookworm main" "deb [trusted=yes] copy://$work/archive ./"
ok "apt finds all that they depend on"

emulated() { qemu-aarch64-static -L "$work/tree" "$@"; }
for program in "$work"/tree/usr/bin/gridspace-*; do
  [ "$(emulated "$program" --version | cut -d' ' -f1)" = "$(basename "$program")" ] || { echo "$program does not start"; exit 1; }
  [ -s "$work/tree/usr/share/man/man8/$(basename "$program").8.gz" ] || { echo "$program has no man page"; exit 1; }
done
ok "every program starts and has a man page: $(cd "$work/tree/usr/bin" && echo gridspace-*)"

# What the emulator itself needs of us stands beside the programs.
mkdir "$work/bin" && ln -s "$work"/tree/usr/bin/gridspace-* "$root/build/arm64/bin/libgridspace-qemu-user.so" "$work/bin/"
scenario=$root/configs/scenarios/protection_arm64.yaml
GRIDSPACE_ARM64_BIN=$work/bin GRIDSPACE_ARM64_ROOT=$work/tree "$gridspace" run "$scenario" --quiet --out "$work/emulated" >"$work/out.txt" 2>&1 || { cat "$work/out.txt"; exit 1; }
"$gridspace" run "$scenario" --quiet --out "$work/native" --set defaults.gridspace-mu.run_on=native --set defaults.gridspace-relay.run_on=native \
  --set defaults.gridspace-breaker.run_on=native >"$work/out.txt" 2>&1 || { cat "$work/out.txt"; exit 1; }
"$gridspace" compare "$work/emulated" "$work/native" || exit 1
ok "case study 2 with them is identical to the native run"
echo "$passed checks of the packages for ARM64, all pass"
