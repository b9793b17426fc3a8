#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# Starts a process of a scenario on a board (used by `gridspace run` for `run_on: ssh:HOST`):
#   start_ssh.sh CABLE PLACE PATIENCE_S CONFIG NAME,MAC,ADDRESS|- ... --- SSH ARGUMENT... --- PROGRAM ARGUMENT...
# Runs in the network namespace of the scenario's host, whose interfaces it hands over to the board: a bridge and a tap each,
# whose frames gridspace-cable carries. The board is given CONFIG, as config.yaml, and every file that CONFIG names.
# Status lines leave on descriptor 3. GRIDSPACE_OUTER_NETWORK names the network namespace of this machine.
set -eu
PATH=$PATH:/usr/sbin:/sbin
cable=$1 place=$2 patience=$3 config=$4
shift 4
fail() { # MESSAGE REMEDY
  echo "$place (start): $1; $2" >&2
  printf '{"status":"failed","code":3,"message":"%s (start): %s","remedy":"%s"}\n' "$place" "$1" "$2" >&3
  exit 3
}
files=$(mktemp -d)
trap 'rm -rf "$files"' EXIT
ports="" n=0
while [ "$1" != --- ]; do
  name=${1%%,*} rest=${1#*,}
  mac=${rest%%,*}
  for old in "bb$n" "tap$n"; do ip link del "$old" 2>/dev/null || true; done # of the board before a restart
  {
    ip addr flush dev "$name" &&
      ip link set "$name" down && ip link set "$name" address "06:${mac#*:}" &&
      ip link add "bb$n" type bridge mcast_snooping 0 stp_state 0 &&
      ip tuntap add "tap$n" mode tap && ip link set "tap$n" txqueuelen 16384 master "bb$n" up &&
      ip link set "$name" master "bb$n" up && ip link set "bb$n" up
  } 2>"$files/errors" || { cat "$files/errors" >&2; fail "the cable cannot be plugged into $name" "run_on: ssh needs root and /dev/net/tun"; }
  ports="$ports --port $1:tap$n"
  n=$((n + 1))
  shift
done
rm -f "$files/errors"
cp "$config" "$files/config.yaml"
for file in $(grep -oE '/[^] ",}]+' "$config" | tr -d "'" | sort -u); do
  [ -f "$file" ] || continue
  name=$(basename "$file")
  [ ! -e "$files/$name" ] || fail "two files of its configuration are called $name" "rename one"
  cp "$file" "$files/$name"
  sed -i "s|$file|$name|g" "$files/config.yaml"
done
trap - EXIT
# shellcheck disable=SC2086 # a list of options
exec "$cable" near --place "$place" --patience "$patience" --files "$files" --outer "${GRIDSPACE_OUTER_NETWORK:-}" $ports "$@"
