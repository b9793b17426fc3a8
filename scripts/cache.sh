# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# What is fetched once for all clones of a user: packages of npm and of Debian's ARM64. Sourced by the scripts in this folder.

# The folder of the cache. GRIDSPACE_CACHE moves it; without a home folder it is in the build folder.
gridspace_cache() {
  local here
  here=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
  if [ -n "${GRIDSPACE_CACHE:-}" ]; then
    printf '%s\n' "$GRIDSPACE_CACHE"
  elif [ -n "${XDG_CACHE_HOME:-${HOME:-}}" ]; then
    printf '%s/gridspace\n' "${XDG_CACHE_HOME:-$HOME/.cache}"
  else
    printf '%s/build/cache\n' "$here"
  fi
}

# debian_mirror: where this machine gets Debian's packages from.
debian_mirror() {
  local mirror
  mirror=$(sed -nE 's/^(deb|URIs:) +(\[[^]]*\] )?(http[^ ]+).*/\3/p' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | head -n 1 || true)
  printf '%s\n' "${mirror:-http://deb.debian.org/debian}"
}

# cached FOLDER COMMAND...: the folder of the cache, made by COMMAND (called with the path of an empty folder beside it) where it is
# not there yet. Whole or not at all, also with two at once: who comes second finds what the first has made.
cached() {
  local folder=$1 fresh # (COMMAND sees these two)
  shift
  [ ! -d "$folder" ] || return 0
  mkdir -p "$(dirname "$folder")" || return
  (
    flock 7
    [ ! -d "$folder" ] || exit 0
    fresh=$(mktemp -d "$folder.XXXXXX") || exit
    if "$@" "$fresh" && chmod 0755 "$fresh" && mv -T "$fresh" "$folder"; then exit 0; fi
    rm -rf "$fresh"
    exit 3
  ) 7>"$folder.lock"
}
