#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace package [--arch amd64|arm64] [OUT]: Debian packages of what is committed, or of an unpacked release, into OUT (build/packages): gridspace, gridspace-agents,
# libgridspace1, libgridspace-dev, python3-gridspace, gridspace-doc; for a foreign architecture those that boards need (agents and library).
# The same commit gives the same octets, wherever it is built.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"

own=$(dpkg --print-architecture) arch="" out=""
while [ $# -gt 0 ]; do
  case $1 in
    --arch) arch=${2:?--arch needs an architecture: amd64 or arm64} && shift ;;
    -h | --help) sed -n '5,7s/^# //p' "$0" && exit 0 ;;
    -*) say "there is no option '$1'; ./gridspace package --help" && exit 2 ;;
    *) out=$1 ;;
  esac
  shift
done
: "${arch:=$own}" "${out:=$root/build/packages}"
[ "$arch" = "$own" ] || [ "$arch" = arm64 ] || { say "packages can be made for $own and arm64, not for $arch"; exit 2; }
checkout=""
[ ! -e "$root/.git" ] || checkout=yes
[ -z "$checkout" ] || [ -z "$(git -C "$root" status --porcelain)" ] || say "what is not committed is not in the packages"

ensure_packages build dashboard package
options=(-b)
if [ "$arch" != "$own" ]; then
  ensure_packages arm64
  options=(-B "-a$arch" "-Pcross,pkg.gridspace.devices" -d)
fi

version=$(sed -nE '1s/.*\((.*)\).*/\1/p' "$root/debian/changelog")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/gridspace-$version
mkdir "$tree"
if [ -n "$checkout" ]; then
  git -C "$root" archive HEAD | tar -x -C "$tree"
else # an unpacked release: all but what was built in it
  tar -c -C "$root" --exclude=./build . | tar -x -C "$tree"
fi
if [ "$arch" != "$own" ]; then # the root file system of the architecture, as for the boards' programs
  "$root/scripts/arm64.sh" sysroot
  mkdir -p "$tree/build" && ln -s "$(readlink -f "$root/build/arm64-sysroot")" "$tree/build/arm64-sysroot"
fi
log=$root/build/package-$arch.log
mkdir -p "$root/build" "$out"
say "making the packages ($arch); the log: $log"
if ! (cd "$tree" && dpkg-buildpackage -us -uc "${options[@]}") >"$log" 2>&1; then
  grep -nE -A 5 'error|Error' "$log" | tail -n 40 >&2 || tail -n 40 "$log" >&2
  say "the packages could not be made (the whole output: $log)"
  exit 3
fi
mv "$work"/*.deb "$out/"
ls "$out"/*_"$arch".deb "$out"/*_all.deb 2>/dev/null
