#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck disable=SC2016 # what runs inside is expanded there
#
# tests/packages/packages_test.sh [FOLDER OF PACKAGES]: the packages of this machine's architecture are what Debian expects of packages
# (lintian), can be installed in a clean Debian 12, work there for an ordinary user, are replaced by newer ones, and leave nothing behind. As root; needs mmdebstrap and a network. What is fetched is kept in the cache of the user.
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
# shellcheck source=scripts/cache.sh
source "$root/scripts/cache.sh"
packages=$(readlink -f "${1:-$root/build/packages}")
arch=$(dpkg --print-architecture)
[ "$(id -u)" -eq 0 ] || { echo "run this as root: it makes a chroot" >&2; exit 3; }
shopt -s nullglob
debs=("$packages"/*_"$arch".deb "$packages"/*_all.deb)
[ "${#debs[@]}" -ge 6 ] || { echo "there are ${#debs[@]} packages in $packages, and not six: ./gridspace package" >&2; exit 2; }

step() { printf '%s %s\n' "$(date -u +%T)" "$1"; }
passed=0
ok() { passed=$((passed + 1)); step "ok   $1"; }

# A clean Debian with what the packages depend on, once for all runs of this user: its key is the dependencies themselves.
depends=$(for deb in "${debs[@]}"; do dpkg-deb -f "$deb" Depends; done | tr ',' '\n' | sed -E 's/\(.*\)//; s/\|.*//; s/:any//; s/ //g' | grep -vE 'gridspace' | sort -u | paste -sd,)
clean_debian() {
  mmdebstrap --quiet --variant=minbase --include="$depends,python3-numpy,g++,cmake,make" bookworm "$1/base.tar" "deb $(debian_mirror) bookworm main"
}
base=$(gridspace_cache)/packages-test/$(printf '%s' "$depends" "$(cat /etc/debian_version)" | sha256sum | cut -c 1-24)
cached "$base" clean_debian

tree=$(mktemp -d /var/tmp/gridspace_packages.XXXXXX)
clean_up() {
  for mount in proc sys dev; do umount -l "$tree/$mount" 2>/dev/null || true; done
  rm -rf --one-file-system "$tree"
}
trap clean_up EXIT
tar -x -C "$tree" -f "$base/base.tar"
mount -t proc proc "$tree/proc"
mount -t sysfs -o ro sys "$tree/sys"
mount --rbind --make-rslave /dev "$tree/dev"
mkdir -p "$tree/packages" "$tree/old_root" && cp "${debs[@]}" "$tree/packages/"
# Not by chroot: in one no user namespace can be made, and runs have one.
inside() {
  unshare -m sh -ec 'mount --rbind "$1" "$1"; cd "$1"; pivot_root . old_root; cd /; umount -l /old_root
    exec /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -ec "$2"' sh "$tree" "$*"
}
as_user() { inside "su somebody -c 'cd && $*'"; }
files_of_system() { (cd "$tree" && find etc usr var/lib -xdev ! -path 'var/lib/dpkg/*' ! -path '*/__pycache__*' ! -path 'var/lib/systemd/*' ! -path 'usr/share/mime*' | sort); }

before=$(files_of_system)
inside 'dpkg -i /packages/*.deb >/tmp/install.log 2>&1' || { cat "$tree/tmp/install.log"; exit 1; }
ok "installed: $(inside 'dpkg-query -W -f "\${Package} " "*gridspace*"')"

inside 'gridspace --version; gridspace-relay --help >/dev/null; gridspace doctor >/tmp/doctor.txt || true; test -s /tmp/doctor.txt' # what it finds is the machine's matter
ok "programs start, and find their libraries"
grep -q 'ExecStart=/usr/bin/gridspace run' "$tree/lib/systemd/system/gridspace@.service"
ok "there is a service for scenarios"
test -s "$tree/usr/share/man/man1/gridspace-run.1.gz"
test -s "$tree/usr/share/man/man8/gridspace-relay.8.gz"
for page in "$tree"/usr/share/man/man[18]/gridspace*; do
  grep -q '^\.SH SYNOPSIS' <(zcat "$page") || { echo "$page says nothing"; exit 1; }
done
ok "there are man pages of verbs and programs"
inside 'source /usr/share/bash-completion/completions/gridspace; complete -p gridspace >/dev/null'
ok "bash completes the command line"

inside 'useradd -m -s /bin/bash somebody'
as_user 'gridspace run /usr/share/gridspace/configs/scenarios/ev_charging.yaml --quiet --out run >out.txt 2>&1' || { cat "$tree/home/somebody/out.txt"; exit 1; }
as_user 'test -s run/data.mcap && gridspace info run >/dev/null && test -s run/report/index.html'
ok "an ordinary user runs case study 1, and all its expectations hold"
as_user 'gridspace run /usr/share/gridspace/configs/scenarios/protection_lockstep.yaml --quiet --out wire >out.txt 2>&1' || { cat "$tree/home/somebody/out.txt"; exit 1; }
ok "and case study 2, with frames on virtual Ethernet"
as_user 'python3 -c "import numpy, gridspace; s = gridspace.open(\"run\").signal(\"bus.B3.v_pu\"); print(numpy.min(s.values))" >python.txt 2>&1 && grep -q "^0.9" python.txt' ||
  { cat "$tree/home/somebody/python.txt"; exit 1; }
ok "Python reads its results, with numpy"
as_user 'gridspace fmu export /usr/share/gridspace/configs/networks/house.yaml --solver phasor --out house.fmu && gridspace fmu info house.fmu | grep "runs here  *yes"' >/dev/null
ok "a network becomes an FMU"
for language in python c++; do
  agent=agent_${language%++}
  as_user "gridspace new agent $agent --language $language >new.txt && if test -f $agent/CMakeLists.txt; then cmake -S $agent -B $agent/build && cmake --build $agent/build; fi >build.txt 2>&1 && gridspace run $agent/scenario.yaml --quiet --out run_$agent >out.txt 2>&1" ||
    { cat "$tree"/home/somebody/{new,build,out}.txt; exit 1; }
  ok "an agent of the user's own, in $language, is built and runs"
done

# A newer version in place of the old one, files of a user untouched.
inside 'echo mine >/etc/gridspace-user-file'
mkdir "$tree/newer"
for deb in "$tree"/packages/*.deb; do
  folder=$(mktemp -d)
  dpkg-deb -R "$deb" "$folder"
  sed -i -E 's/^Version: (.*)/Version: \1+1/; s/\(= ([^)]*)\)/(= \1+1)/g' "$folder/DEBIAN/control"
  dpkg-deb -Znone --root-owner-group -b "$folder" "$tree/newer/" >/dev/null
  rm -rf "$folder"
done
inside 'dpkg -i /newer/*.deb >/tmp/upgrade.log 2>&1' || { cat "$tree/tmp/upgrade.log"; exit 1; }
inside 'dpkg-query -W -f "\${Version}\n" gridspace | grep -q "+1$" && gridspace --version >/dev/null'
ok "replaced by newer ones"

inside 'test "$(cat /etc/gridspace-user-file)" = mine; rm /etc/gridspace-user-file; userdel -r somebody 2>/dev/null || true; dpkg -P gridspace gridspace-agents libgridspace-dev libgridspace1 python3-gridspace gridspace-doc >/tmp/remove.log 2>&1' || { cat "$tree/tmp/remove.log"; exit 1; }
left=$(diff <(printf '%s\n' "$before") <(files_of_system) | grep '^>' | grep -vE '^> (etc/(passwd|group|shadow|gshadow|subuid|subgid)-?|var/lib/dpkg.*)$' || true)
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
ok "removed, and nothing is left"

lintian --allow-root --fail-on error,warning "${debs[@]}"
ok "lintian has nothing to say; its exceptions, with reasons: debian/*.lintian-overrides"
python3 "$root/scripts/sbom.py" "$packages" | python3 "$root/tests/packages/check_spdx.py"
ok "the list of parts is valid SPDX"
echo "$passed passed, 0 failed"
