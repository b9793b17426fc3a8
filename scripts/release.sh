#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace release [--draft] [OUT]: what is published of a version, made of what is committed, into OUT (build/release-VERSION): the source as
# a tarball; the Debian packages for amd64 and arm64, made of that tarball; what they are made of (SPDX); the sums of all these files. The packages
# of this machine's architecture are made twice, in different folders, the second time without the compiler's cache, and have to be the same octets.
# --draft: also of a version that CHANGELOG.md calls "not released", and for this machine's architecture only.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"

draft="" out=""
while [ $# -gt 0 ]; do
  case $1 in
    --draft) draft=yes ;;
    -h | --help) sed -n '5,8s/^# //p' "$0" && exit 0 ;;
    -*) say "there is no option '$1'; ./gridspace release --help" && exit 2 ;;
    *) out=$1 ;;
  esac
  shift
done
git -C "$root" rev-parse -q --verify HEAD >/dev/null || { say "a release is made of what is committed, and this is no git checkout"; exit 2; }
[ -z "$(git -C "$root" status --porcelain)" ] || { say "there is something that is not committed: git status"; exit 2; }

# One version, everywhere.
version=$(sed -nE 's/^project\(gridspace VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt")
packaged=$(sed -nE '1s/.*\((.*)\).*/\1/p' "$root/debian/changelog")
heading=$(sed -nE '/^## /{s/^## //p;q}' "$root/CHANGELOG.md")
[ "$packaged" = "$version" ] || { say "debian/changelog is at $packaged, and CMakeLists.txt at $version"; exit 2; }
case $heading in
  "$version (not released)") [ -n "$draft" ] || { say "CHANGELOG.md calls $version not released: give it its date, or --draft"; exit 2; } ;;
  "$version ("[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]")") ;;
  *) say "CHANGELOG.md begins with '$heading', and not with '$version (YYYY-MM-DD)'"; exit 2 ;;
esac
: "${out:=$root/build/release-$version}"
mkdir -p "$out"
[ -z "$(ls -A "$out")" ] || { say "there is something in $out already"; exit 2; }
out=$(readlink -f "$out")

tarball=$out/gridspace-$version.tar.gz
git -C "$root" archive --format=tar --prefix="gridspace-$version/" HEAD | gzip -9n >"$tarball"
say "the source: $tarball"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
own=$(dpkg --print-architecture)
tar -x -C "$work" -f "$tarball"
"$work/gridspace-$version/gridspace" package "$out"
mkdir -p "$work/in/another/folder/again"
tar -x -C "$work/in/another/folder" -f "$tarball"
say "once more, in another folder and compiled anew"
CCACHE_DISABLE=1 TMPDIR=$work/in/another/folder "$work/in/another/folder/gridspace-$version/gridspace" package "$work/in/another/folder/again" >/dev/null
differ=""
for deb in "$out"/*.deb; do
  cmp -s "$deb" "$work/in/another/folder/again/$(basename "$deb")" || differ="$differ $(basename "$deb")"
done
if [ -n "$differ" ]; then
  mkdir -p "$root/build/not_reproducible" && cp "$work"/in/another/folder/again/*.deb "$root/build/not_reproducible/"
  say "not the same octets twice:$differ; the others are in build/not_reproducible (diffoscope shows where)"
  exit 1
fi
say "the packages are the same octets, made twice"
if [ -z "$draft" ] && [ "$own" != arm64 ]; then
  "$work/gridspace-$version/gridspace" package --arch arm64 "$out"
fi
python3 "$root/scripts/sbom.py" "$out" >"$out/gridspace-$version.spdx.json"
(cd "$out" && sha256sum -- *.tar.gz *.deb *.spdx.json >SHA256SUMS)
ls -l "$out"
