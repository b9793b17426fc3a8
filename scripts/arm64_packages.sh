# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# shellcheck disable=SC2154 # root
# Debian's arm64 packages, unpacked into a folder. Sourced by scripts/arm64.sh and the scripts of the board image, which set `root`.
#
# They are never installed: apt keeps books of its own, so that no root is needed, no package of this machine is touched, and packages
# that cannot stand beside their amd64 twins do no harm. Books, packages and what is unpacked from them are in the cache of the user;
# the build folder holds links to them.
# shellcheck source=scripts/cache.sh
source "$root/scripts/cache.sh"
arm64_cache=$(gridspace_cache)/arm64

# What is needed to compile and link the agents, the gateways, the detector, their tests, and what these need to run.
# shellcheck disable=SC2034 # used by who sources this
arm64_build_packages="libc6-dev libstdc++-12-dev libfastrtps-dev libfastcdr-dev libssl-dev libasio-dev libtinyxml2-dev libeigen3-dev libyaml-cpp-dev
  libcli11-dev nlohmann-json3-dev libfmt-dev libgtest-dev libgmock-dev librapidcheck-dev zlib1g-dev libzstd-dev liblz4-dev libboost-dev"

# arm64_apt VERB ...: apt-get of the foreign architecture, with books of its own.
arm64_apt() { APT_CONFIG="$arm64_cache/apt.conf" apt-get -qq "$@"; }

# Fetches the package lists, from the Debian mirrors that this machine uses, once a day.
arm64_update() {
  command -v apt-get >/dev/null 2>&1 || { say "the packages for ARM64 are Debian's, and this machine has no apt-get"; return 3; }
  [ -z "$(find "$arm64_cache/.updated" -mtime -1 2>/dev/null)" ] || return 0
  mkdir -p "$arm64_cache"/{state/lists/partial,cache/archives/partial,etc/apt.conf.d,etc/preferences.d}
  : >"$arm64_cache/status"
  local mirrors
  # shellcheck disable=SC2016 # apt's fields
  mirrors=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' 'Origin: Debian' 2>/dev/null |
    awk '$2 ~ /^bookworm/ && $3 == "main"' | sort -u)
  [ -n "$mirrors" ] || mirrors='http://deb.debian.org/debian bookworm main
http://deb.debian.org/debian-security bookworm-security main'
  awk '{ print "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]", $0 }' <<<"$mirrors" >"$arm64_cache/etc/sources.list"
  cat >"$arm64_cache/apt.conf" <<CONF
#clear APT::Architectures;
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
APT::Sandbox::User "";
Dir "$arm64_cache/";
Dir::State "state";
Dir::State::status "$arm64_cache/status";
Dir::Cache "cache";
Dir::Etc "etc";
Acquire::Languages "none";
Acquire::Retries "3";
CONF
  local log=$arm64_cache/update.log
  if ! arm64_apt update >"$log" 2>&1; then
    tail -n 5 "$log" >&2
    say "the lists of Debian's arm64 packages could not be fetched (above: the end of $log). Is there a network?"
    return 3
  fi
  touch "$arm64_cache/.updated"
}

# arm64_closure PACKAGE...: prints the files (.deb) of the packages and of all that they depend on, fetched if need be.
arm64_closure() {
  local log=$arm64_cache/fetch.log wanted
  # shellcheck disable=SC2068 # lists of names
  if ! arm64_apt install --download-only -y $@ >"$log" 2>&1 ||
    ! wanted=$(arm64_apt install --print-uris -y -o Dir::Cache::archives=/nonexistent $@ 2>>"$log"); then
    tail -n 10 "$log" >&2
    say "Debian's arm64 packages could not be fetched (above: the end of $log)"
    return 3
  fi
  awk -v folder="$arm64_cache/cache/archives/" 'NF >= 2 { print folder $2 }' <<<"$wanted"
}

# arm64_unpack LINK PACKAGE...: LINK leads to a root file system of the packages and what they depend on.
arm64_unpack() {
  local link=$1 folder
  shift
  folder=$arm64_cache/root-$(printf '%s\n' "$@" "$(cat /etc/debian_version)" | sha256sum | cut -c 1-24)
  cached "$folder" arm64_unpack_into "$folder" "$@" && arm64_mend_links "$folder" || return
  mkdir -p "$(dirname "$link")" "$root/build"
  ln -sfn "$arm64_cache" "$root/build/arm64-packages"
  [ -L "$link" ] || rm -rf "$link"
  ln -sfn "$folder" "$link"
}

# arm64_mend_links FOLDER: absolute links of libraries, which would lead out of the folder, become relative. CMake would otherwise find the
# static library beside such a link, and no package would be known to depend on the shared one. Quick where nothing is left to do.
arm64_mend_links() {
  local link
  find "$1/usr/lib" -lname '/*' -name '*.so*' -print0 | while IFS= read -r -d '' link; do
    [ ! -e "$1$(readlink "$link")" ] || ln -sfrn "$1$(readlink "$link")" "$link" || return
  done
}

# arm64_unpack_into NAME PACKAGE... FOLDER: the same into an empty folder that will be called NAME. One at a time: apt has one set of books.
arm64_unpack_into() {
  local name=$1 folder=${*: -1} files file
  set -- "${@:2:$#-2}"
  mkdir -p "$arm64_cache"
  {
    flock 6
    arm64_update && files=$(arm64_closure "$@") || return
  } 6>"$arm64_cache/apt.lock"
  say "unpacking $(wc -l <<<"$files") arm64 packages into $name"
  mkdir -p "$folder"/usr/{bin,sbin,lib} && ln -s usr/bin usr/sbin usr/lib "$folder/" || return
  for file in $files; do
    dpkg-deb --fsys-tarfile "$file" | tar -x -C "$folder" --keep-directory-symlink --no-same-owner \
      --exclude='./usr/share/doc/*' --exclude='./usr/share/man/*' --exclude='./usr/share/locale/*' --exclude='./usr/share/info/*' || return
  done
  # Some CMake files name where Debian installs them.
  find "$folder/usr/lib" -name '*.cmake' -exec sed -i "s|\\([\" ;]\\)/usr/|\\1$name/usr/|g" {} +
}
