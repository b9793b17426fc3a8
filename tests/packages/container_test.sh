#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# tests/packages/container_test.sh [FOLDER OF PACKAGES]: the container recipe makes an image of the packages, which runs case study 1 without
# privileges; the compose file runs it on two sites. As root; needs podman, podman-compose, mmdebstrap and a network. Where no registry can be
# reached, a Debian that mmdebstrap makes stands in for the image that the recipe begins with; the output says so.
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
# shellcheck source=scripts/cache.sh
source "$root/scripts/cache.sh"
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
packages=$(readlink -f "${1:-$root/build/packages}")
[ "$(id -u)" -eq 0 ] || { echo "run this as root: it makes a chroot" >&2; exit 3; }
ensure_packages containers
shopt -s nullglob
debs=("$packages"/*.deb)
[ "${#debs[@]}" -ge 6 ] || { echo "there are ${#debs[@]} packages in $packages, and not six: ./gridspace package" >&2; exit 2; }
passed=0
step() { printf '%s %s\n' "$(date -u +%T)" "$1"; }
ok() { passed=$((passed + 1)); step "ok   $1"; }

work=$(mktemp -d)
name=gridspace-test-$$ base=docker.io/library/debian:bookworm-slim stand_in=""
clean_up() {
  (cd "$work" && podman-compose -p "$name" -f packaging/two_sites.compose.yaml down >/dev/null 2>&1) || true
  podman rmi -f "$name" ${stand_in:+"$base"} >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap clean_up EXIT

slim_debian() { mmdebstrap --quiet --variant=minbase --include=ca-certificates bookworm "$1/base.tar" "deb $(debian_mirror) bookworm main"; }
if ! podman image exists "$base" && ! timeout 60 podman pull -q "$base" >/dev/null 2>&1; then
  step "no registry: a Debian of mmdebstrap stands in for $base"
  tree=$(gridspace_cache)/container-test/$(sha256sum </etc/debian_version | cut -c 1-24)
  cached "$tree" slim_debian
  stand_in=yes # it goes at the end: nobody shall take it for the real one
  podman import -q "$tree/base.tar" "$base" >/dev/null
fi

# No more than this machine permits; and a runtime that takes it where it has both versions of control groups.
printf '[containers]\ndefault_ulimits = ["nofile=4096:4096", "nproc=4096:4096"]\n' >"$work/containers.conf"
if [ -d /sys/fs/cgroup/unified ]; then
  step "this machine has both versions of control groups, which crun refuses: runc"
  printf '[engine]\nruntime = "runc"\ncgroup_manager = "cgroupfs"\n' >>"$work/containers.conf"
  export BUILDAH_ISOLATION=chroot
fi
export CONTAINERS_CONF=$work/containers.conf
mkdir "$work/packages"
cp "${debs[@]}" "$work/packages/"
# apt's settings of this machine (a proxy) count inside too.
podman build -q --network host -v /etc/apt/apt.conf.d:/etc/apt/apt.conf.d:ro -f "$root/packaging/Containerfile" -t "$name" "$work/packages" >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }
ok "the recipe makes an image of the packages"

mkdir -m 777 "$work/runs"
podman run --rm --cap-drop=all --security-opt no-new-privileges -v "$work/runs:/runs" "$name" >"$work/case_1.txt" 2>&1 || { cat "$work/case_1.txt"; exit 1; }
for file in data.mcap report/index.html; do
  test -s "$work/runs/ev_charging/$file" || { echo "no $file"; exit 1; }
done
ok "case study 1 runs in it without a capability, and all its expectations hold"
podman run --rm "$name" --version | grep -q gridspace
ok "its entry is the command line"

# Two sites, from a checkout of nothing but the example and the recipe; keys as its README says.
mkdir -p "$work/examples" && cp -r "$root/examples/two_sites" "$work/examples/" && cp -r "$root/packaging" "$work/"
awk '/^```$/ { inside++; next } inside == 1' "$root/examples/two_sites/README.md" >"$work/keys.sh" # its first block
(cd "$work/examples/two_sites" && bash -e "$work/keys.sh") >"$work/keys.log" 2>&1 || { cat "$work/keys.log"; exit 1; }
chmod -R a+rX "$work/examples"
cd "$work"
GRIDSPACE_IMAGE=$name timeout 600 podman-compose -p "$name" -f packaging/two_sites.compose.yaml up -d >"$work/compose.log" 2>&1 || { cat "$work/compose.log"; exit 1; }
code=$(timeout 600 podman wait "${name}_grid_1")
[ "$code" = 0 ] || { podman logs "${name}_grid_1"; podman logs "${name}_agent_1"; exit 1; }
test -s "$work/runs/two_sites/data.mcap" || { echo "no results of two sites"; exit 1; }
ok "the compose file runs it on two sites"
podman run --rm -v "$work/runs:/runs" "$name" info /runs/two_sites >"$work/info.txt"
requests=$(awk '$1 == "requests" { print $3 }' "$work/info.txt") # each of the four asks 81 times
[ "${requests:-0}" -gt 270 ] || { cat "$work/info.txt"; podman logs "${name}_agent_1"; exit 1; }
ok "and the agent of the other site has taken part"
echo "$passed passed, 0 failed"
