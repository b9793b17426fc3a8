# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# Debian packages by group, and their installation. Sourced by ./gridspace and the scripts in this folder.

# What each group is for, and its packages. `command|package` asks for a command and installs the package only where it is missing,
# so that a newer Node.js or a compiler from elsewhere counts.
declare -A group_purpose=(
  [build]="compiling Gridspace and running scenarios"
  [dashboard]="building the browser dashboard"
  [test]="the tests and their judges (tshark, CycloneDDS, linuxptp)"
  [all]="sanitizer and fuzz builds, static analysis, ngspice as judge, Slurm, a virtual machine as a guest"
  [bench]="measuring how fast it is"
  [e2e]="the dashboard in a browser"
  [docs]="the documentation as a site"
  [package]="making Debian packages and trying them in a clean Debian"
  [containers]="trying the packages in containers"
  [languages]="programs in other languages in simulated time"
  [arm64]="cross-compiling for ARM64 and running it in emulation"
)
declare -A group_packages=(
  [build]="c++|g++ make cmake ninja-build ccache mold git ca-certificates pkg-config libfastrtps-dev libfastcdr-dev fastddsgen java|default-jre-headless libssl-dev
           libasio-dev liblwip-dev libtinyxml2-dev libeigen3-dev libsundials-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libboost-dev libzstd-dev
           liblz4-dev zlib1g-dev libminizip-dev libsqlite3-dev ip|iproute2 procps util-linux"
  [dashboard]="node|nodejs npm|npm"
  [test]="libgtest-dev libgmock-dev librapidcheck-dev cyclonedds-dev cyclonedds-tools tshark|tshark ptp4l|linuxptp mosquitto mosquitto-clients libmodbus-dev python3|python3 python3-yaml python3-scipy python3-pandas python3-matplotlib python3-nbclient
          python3-ipykernel sshd|openssh-server ssh|openssh-client setpriv|util-linux node|nodejs npm|npm"
  [all]="clang-19 clang-tidy-19 clang-format-19 libclang-rt-19-dev llvm-19 lld-19 shellcheck ngspice libbenchmark-dev slurmctld slurmd sbatch|slurm-client munge
        qemu-system-x86_64|qemu-system-x86 cpio|cpio"
  [bench]="libbenchmark-dev ngspice python3|python3 python3-numpy"
  [e2e]="chromium|chromium node|nodejs npm|npm"
  [docs]="mkdocs|mkdocs mkdocs-material"
  [package]="debhelper dh-python help2man lintian mmdebstrap dpkg-dev"
  [containers]="podman|podman runc|runc golang-github-containernetworking-plugin-dnsname dnsmasq-base podman-compose|podman-compose mmdebstrap"
  [languages]="go|golang-go rustc|rustc javac|default-jdk-headless"
  [arm64]="g++-aarch64-linux-gnu qemu-user-static qemu-system-aarch64|qemu-system-arm cpio|cpio systemd-analyze|systemd readelf|binutils"
)

say() { printf 'gridspace: %s\n' "$*" >&2; }

# missing_packages GROUP...: prints what is not there.
missing_packages() {
  local group entry
  for group in "$@"; do
    for entry in ${group_packages[$group]}; do
      case $entry in
        *'|'*) command -v "${entry%|*}" >/dev/null 2>&1 || PATH=$PATH:/usr/sbin:/sbin command -v "${entry%|*}" >/dev/null 2>&1 || echo "${entry#*|}" ;;
        *) [ "$(dpkg-query -W -f='${db:Status-Status}' "$entry" 2>/dev/null)" = installed ] || echo "$entry" ;;
      esac
    done
  done | sort -u
}

# ensure_packages GROUP...: installs what is missing, after saying what and why. Exit code 3 when that is not possible.
ensure_packages() {
  if ! command -v dpkg-query >/dev/null 2>&1; then
    say "this is not Debian, so nothing is installed for you; needed for ${group_purpose[$1]}: ${group_packages[$1]//[$'\n']/ }"
    return 0
  fi
  local missing
  missing=$(missing_packages "$@" | tr '\n' ' ')
  [ -n "${missing// /}" ] || return 0
  local purposes="" group
  for group in "$@"; do purposes+="${purposes:+; }${group_purpose[$group]}"; done
  local -a install=(apt-get install -y --no-install-recommends --no-remove -o DPkg::Lock::Timeout=600)
  say "Debian packages are missing for: $purposes"
  say "  $missing"
  if [ -n "${GRIDSPACE_NO_INSTALL:-}" ]; then
    say "GRIDSPACE_NO_INSTALL is set, so nothing was installed. As root: ${install[*]} $missing"
    return 3
  fi
  local -a as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null 2>&1; then
      say "they have to be installed as root, and there is no sudo here. As root: ${install[*]} $missing"
      return 3
    fi
    as_root=(sudo)
  fi
  say "installing them now with: ${as_root[*]:+${as_root[*]} }${install[*]} …"
  local log
  log=$(mktemp)
  # shellcheck disable=SC2086 # a list of names
  if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq -o DPkg::Lock::Timeout=600 &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive "${install[@]}" -qq $missing; } >"$log" 2>&1; then
    tail -n 15 "$log" >&2
    say "the installation failed (above: the end of $log). Is there a network, and is this Debian 12?"
    return 3
  fi
  rm -f "$log"
}
