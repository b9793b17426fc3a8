#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# Packs one process for a board (used by `gridspace bundle`, which has checked that the program is for the architecture):
#   bundle.sh NAME ARCH PROGRAM STAGE ROOT OUT VERSION
# STAGE/conf holds its config.yaml, the files that this names, and network; ROOT is a file system of ARCH with the libraries. Makes OUT/gridspace-NAME_ARCH.tar.gz, which
# brings its libraries along, and OUT/gridspace-NAME_ARCH.deb, which depends on Debian's.
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
sed -e "s|@NAME@|$name|g; s|@PROGRAM@|$base|g; s|@ARCH@|$arch|g; s|@MACHINE@|$machine|g" "$here/README.in" >"$stage/README"
sed 's/^/    /' "$stage/conf/network" >>"$stage/README"

mkdir -p "$stage/lib"
collect "$program" "$root" "$stage/lib"

tree=$stage/gridspace-$name
mkdir -p "$tree/bin" "$tree/conf"
strip_to "$program" "$tree/bin/$base"
strip_to "$(dirname "$program")/gridspace-cable" "$tree/bin/gridspace-cable" # for `run_on: ssh:HOST` with what is installed
cp "$stage/start" "$tree/start" && cp "$stage/README" "$tree/README" && cp -r "$stage/lib" "$tree/lib" && cp "$stage"/conf/* "$tree/conf/"
sed "s|/usr/lib/gridspace/$name|/opt/gridspace-$name|g" "$stage/gridspace-$name.service" >"$tree/gridspace-$name.service"
chmod 755 "$tree/start" "$tree"/bin/*
tar -C "$stage" --owner=0 --group=0 --sort=name --mtime=@0 -czf "$out/gridspace-${name}_$arch.tar.gz" "gridspace-$name"

# The Debian package: program and start script in /usr/lib/gridspace/NAME, configuration in /etc/gridspace/NAME.
deb=$stage/deb
mkdir -p "$deb/DEBIAN" "$deb/usr/lib/gridspace/$name/bin" "$deb$conf" "$deb/lib/systemd/system" "$deb/usr/share/doc/gridspace-$name"
cp "$tree"/bin/* "$deb/usr/lib/gridspace/$name/bin/"
cp "$stage/start" "$deb/usr/lib/gridspace/$name/start" && chmod 755 "$deb/usr/lib/gridspace/$name/start"
cp "$stage"/conf/* "$deb$conf/"
cp "$stage/gridspace-$name.service" "$deb/lib/systemd/system/"
cp "$stage/README" "$deb/usr/share/doc/gridspace-$name/README"
depends=""
for library in $(needed "$program"); do
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
    *) fail "no Debian package is known for the library $library" "add it to $0" ;;
  esac
  case ", $depends," in *", $package,"*) ;; *) depends="$depends${depends:+, }$package" ;; esac
done
debname=gridspace-$(printf '%s' "$name" | tr '[:upper:]_' '[:lower:]-')
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
(cd "$deb" && find etc -type f | sed 's|^|/|') >"$deb/DEBIAN/conffiles"
cat >"$deb/DEBIAN/postinst" <<POST
#!/bin/sh
set -e
if [ "\$1" = configure ] && [ -z "\${DPKG_ROOT:-}" ] && [ -d /run/systemd/system ]; then
  systemctl daemon-reload
  echo "gridspace-$name: read /usr/share/doc/gridspace-$name/README, then: systemctl enable --now gridspace-$name"
fi
POST
chmod 755 "$deb/DEBIAN/postinst"
find "$deb" -type d -exec chmod 755 {} +
dpkg-deb --root-owner-group -Zxz --build "$deb" "$out/gridspace-${name}_$arch.deb" >/dev/null
echo "$out/gridspace-${name}_$arch.tar.gz"
echo "$out/gridspace-${name}_$arch.deb"
