#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/fresh_machine_test.sh [FOLDER] [-- COMMAND...]: proves that a clean Debian 12 can use a fresh clone. As root; needs mmdebstrap and
# a network. Makes a minbase tree, clones this repository (what is committed) into it, and runs the two commands of the README there, or COMMAND.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/cache.sh
source "$root/scripts/cache.sh"
[ "$(id -u)" -eq 0 ] || { echo "run this as root: it makes a chroot" >&2; exit 3; }
command -v mmdebstrap >/dev/null || { echo "mmdebstrap is missing: apt-get install mmdebstrap" >&2; exit 3; }

tree=$(mktemp -d /var/tmp/gridspace_fresh.XXXXXX)
if [ $# -gt 0 ] && [ "$1" != -- ]; then tree=$1; shift; fi
[ "${1:-}" != -- ] || shift

clean_up() {
  for mount in proc sys dev/pts dev; do umount -l "$tree/$mount" 2>/dev/null || true; done
  rm -rf --one-file-system "$tree"
}
trap clean_up EXIT

mmdebstrap --variant=minbase --include=git,ca-certificates bookworm "$tree" \
  "deb $(debian_mirror) bookworm main" "deb $(debian_mirror) bookworm-updates main" \
  "deb http://deb.debian.org/debian-security bookworm-security main"
cp /etc/resolv.conf "$tree/etc/resolv.conf"
# Whatever proxy or mirror this machine uses to reach the archives, the new one needs as well.
cp /etc/apt/apt.conf.d/*proxy* "$tree/etc/apt/apt.conf.d/" 2>/dev/null || true
mount -t proc proc "$tree/proc"
mount -t sysfs -o ro sys "$tree/sys"
mount --rbind --make-rslave /dev "$tree/dev"

git clone -q --no-hardlinks "$root" "$tree/opt/gridspace"
inside() { chroot "$tree" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 bash -c "cd /opt/gridspace && $*"; }
if [ $# -gt 0 ]; then
  inside "$@"
else
  inside "./gridspace run configs/scenarios/ev_charging.yaml && ./gridspace test"
fi
echo "a fresh Debian 12 can use this"
