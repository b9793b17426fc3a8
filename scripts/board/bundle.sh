#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# Packs one process for a board (used by `gridspace bundle`, which has checked that the program is for the architecture):
#   bundle.sh NAME ARCH PROGRAM STAGE ROOT OUT VERSION
# STAGE/conf holds its config.yaml, the files that this names, and network; ROOT is a file system of ARCH with the libraries. Makes OUT/gridspace-NAME_ARCH.tar.gz, which
# brings its libraries along, and OUT/gridspace-NAME_ARCH.deb, which depends on Debian's. SOURCE_DATE_EPOCH, if set, is the time at which
# that is; the same content is then the same bundle.
set -eu
name=$1 arch=$2 program=$3 stage=$4 root=$5 out=$6 version=$7
here=$(dirname "$(readlink -f "$0")")
# shellcheck source=scripts/board/stage.sh
. "$here/stage.sh"
of_arch "$arch"
for tool in dpkg-deb readelf; do command -v "$tool" >/dev/null || fail "the program $tool is missing" "apt install dpkg binutils"; done
base=$(basename "$program")

conf=/etc/gridspace/$name # of the package
# What it may do on the board: raw frames for who sends or receives them, nothing more.
raw=""
grep -q '^  wire:' "$stage/conf/config.yaml" && raw=yes
{
  sed -e "s|@NAME@|$name|g; s|@PROGRAM@|$base|g" "$here/gridspace.service.in"
  if [ -n "$raw" ]; then
    printf 'AmbientCapabilities=CAP_NET_RAW\nCapabilityBoundingSet=CAP_NET_RAW\nRestrictAddressFamilies=AF_INET AF_NETLINK AF_UNIX AF_PACKET\n'
  else
    printf 'CapabilityBoundingSet=\nRestrictAddressFamilies=AF_INET AF_NETLINK AF_UNIX\n'
  fi
} >"$stage/gridspace-$name.service"
sed -e "s|@NAME@|$name|g; s|@PROGRAM@|$base|g; s|@MACHINE@|$machine|g" "$here/start.in" >"$stage/start"

# What the Debian package depends on: what the program links to.
depends=$(depends_of "$program")
debname=gridspace-$(printf '%s' "$name" | tr '[:upper:]_' '[:lower:]-')
packages=$(printf '%s\n' "$depends" | sed 's/ ([^)]*)//g' | tr -d ',' | tr ' ' '\n' | LC_ALL=C sort -u | tr '\n' ' ' | sed 's/ $//')
sed -e "s|@NAME@|$name|g; s|@PROGRAM@|$base|g; s|@ARCH@|$arch|g; s|@MACHINE@|$machine|g; s|@DEBNAME@|$debname|g; s|@DEPENDS@|$packages|g" \
  "$here/README.in" >"$stage/README"
sed 's/^/    /' "$stage/conf/network" >>"$stage/README"

mkdir -p "$stage/lib"
collect "$program" "$root" "$stage/lib"

# Under which terms the libraries are that the tarball brings along: as Debian's packages of them say (of whatever architecture).
mkdir -p "$stage/licenses"
for text in "$here/../../LICENSE" "$here/../../../doc/gridspace/LICENSE"; do # source tree or installed
  [ ! -f "$text" ] || cp "$text" "$stage/licenses/gridspace"
done
[ -f "$stage/licenses/gridspace" ] || fail "the file LICENSE of Gridspace is missing" "is it installed completely?"
# Once for all of them: it reads the lists of all packages.
owners=$(find "$stage/lib" -type f -printf "*/*-linux-gnu/%f\n" | xargs dpkg-query -S 2>/dev/null || true)
for library in "$stage"/lib/*; do
  library=$(basename "$library")
  package=$(printf '%s\n' "$owners" | awk -v file="/$library" 'substr($0, length($0) - length(file) + 1) == file { sub(/[:,].*/, ""); print; exit }')
  found=""
  for text in "$root/usr/share/doc/$package/copyright" "/usr/share/doc/$package/copyright"; do
    [ -z "$package" ] || [ ! -f "$text" ] || found=$text
  done
  [ -n "$found" ] || fail "the terms of the library $library are not known: no Debian package of this machine has it" "apt install it here"
  cp -L "$found" "$stage/licenses/$package"
done

tree=$stage/gridspace-$name
mkdir -p "$tree/bin" "$tree/conf"
strip_to "$program" "$tree/bin/$base"
strip_to "$(dirname "$program")/gridspace-cable" "$tree/bin/gridspace-cable" # for `run_on: ssh:HOST` with what is installed
cp "$stage/start" "$tree/start" && cp "$stage/README" "$tree/README" && cp -r "$stage/lib" "$stage/licenses" "$tree/" && cp "$stage"/conf/* "$tree/conf/"
sed "s|/usr/lib/gridspace/$name\|/usr/share/doc/gridspace-$name|/opt/gridspace-$name|g" "$stage/gridspace-$name.service" >"$tree/gridspace-$name.service"
chmod 755 "$tree/start" "$tree"/bin/*
chmod -R u=rwX,go=rX "$tree" # the service runs as nobody in particular
tar -C "$stage" --owner=0 --group=0 --sort=name --mtime=@0 -czf "$out/gridspace-${name}_$arch.tar.gz" "gridspace-$name"

# The Debian package: program and start script in /usr/lib/gridspace/NAME, configuration in /etc/gridspace/NAME.
deb=$stage/deb
mkdir -p "$deb/DEBIAN" "$deb/usr/lib/gridspace/$name/bin" "$deb$conf" "$deb/lib/systemd/system" "$deb/usr/share/doc/gridspace-$name"
cp "$tree"/bin/* "$deb/usr/lib/gridspace/$name/bin/"
cp "$stage/start" "$deb/usr/lib/gridspace/$name/start" && chmod 755 "$deb/usr/lib/gridspace/$name/start"
cp "$stage"/conf/* "$deb$conf/"
cp "$stage/gridspace-$name.service" "$deb/lib/systemd/system/"
cp "$stage/README" "$deb/usr/share/doc/gridspace-$name/README"
cat >"$deb/usr/share/doc/gridspace-$name/copyright" <<COPYRIGHT
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: Gridspace

Files: *
Copyright: 2026 Gridspace contributors
License: Apache-2.0
 On Debian systems the full text of this license is in /usr/share/common-licenses/Apache-2.0.
COPYRIGHT
# A bundle that is made later is newer, or apt would keep the one that is installed; the hash tells contents apart.
seconds=${SOURCE_DATE_EPOCH:-$(date +%s)}
hash=$(cd "$deb" && find . -type f -exec sha256sum {} + | LC_ALL=C sort -k 2 | sha256sum | cut -c 1-8)
version=$version+$(date -u -d "@$seconds" +%Y%m%d.%H%M%S).$hash
cat >"$deb/DEBIAN/control" <<CONTROL
Package: $debname
Version: $version
Architecture: $arch
Maintainer: Gridspace contributors <noreply@example.org>
Depends: $depends
Section: science
Priority: optional
Description: Gridspace device '$name' ($base)
 One process of a Gridspace scenario, configured, as a service of systemd.
CONTROL
(cd "$deb" && find etc -type f | LC_ALL=C sort | sed 's|^|/|') >"$deb/DEBIAN/conffiles"
# Scripts of the package: each does something where systemd runs alone.
script() { # NAME, and what it does on standard input
  {
    # shellcheck disable=SC2016 # the package's variable
    printf '#!/bin/sh\nset -e\n[ -z "${DPKG_ROOT:-}" ] && [ -d /run/systemd/system ] || exit 0\n'
    cat
  } >"$deb/DEBIAN/$1"
  chmod 755 "$deb/DEBIAN/$1"
}
script postinst <<POST
[ "\$1" = configure ] || exit 0
systemctl daemon-reload
if [ -n "\${2:-}" ]; then
  systemctl try-restart gridspace-$name.service
else
  echo "gridspace-$name: read /usr/share/doc/gridspace-$name/README, then: systemctl enable --now gridspace-$name"
fi
POST
script prerm <<PRE
[ "\$1" != remove ] || systemctl --no-reload disable --now gridspace-$name.service
PRE
script postrm <<POST
[ "\$1" != remove ] || systemctl daemon-reload
POST
chmod -R u=rwX,go=rX "$deb"
find "$deb" -exec touch -d "@$seconds" {} +
SOURCE_DATE_EPOCH=$seconds dpkg-deb --root-owner-group -Zxz -z2 --build "$deb" "$out/gridspace-${name}_$arch.deb" >/dev/null
echo "$out/gridspace-${name}_$arch.tar.gz"
echo "$out/gridspace-${name}_$arch.deb"
