# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# shellcheck disable=SC2154 # root
# Configures and builds. Sourced by ./gridspace and scripts/test.sh, which set `root`; everything goes to stderr.

# ninja takes one job more than there are processors, and the heaviest file needs about 1 GB: fewer jobs where memory is short.
build_jobs() {
  local processors memory_gb
  processors=$(nproc)
  memory_gb=$(awk '/MemAvailable/ {print int($2 / 1048576)}' /proc/meminfo)
  echo $((memory_gb < processors ? (memory_gb > 0 ? memory_gb : 1) : processors))
}

# configure PRESET [cmake options]: only where something would change.
configure() {
  local preset=$1
  shift
  local stamp="$root/build/$preset/.configured" wanted="$*"
  if [ -f "$stamp" ] && [ -f "$root/build/$preset/build.ninja" ] && [ "$(cat "$stamp")" = "$wanted" ]; then return 0; fi
  local log="$root/build/configure-$preset.log"
  mkdir -p "$root/build"
  if ! (cd "$root" && cmake --preset "$preset" "$@") >"$log" 2>&1; then
    tail -n 30 "$log" >&2
    say "cmake could not configure the preset $preset (above: the end of $log)"
    return 3
  fi
  echo "$wanted" >"$stamp"
}

# told_every SECONDS PID PRESET LOG: while the build runs, how far it is: "412 of 703 steps, about 3 min left".
told_every() {
  local interval=$1 pid=$2 preset=$3 log=$4 began=$SECONDS done_steps all_steps
  while kill -0 "$pid" 2>/dev/null; do
    timeout "$interval" tail --pid="$pid" -s 0.2 -f /dev/null && break
    read -r done_steps all_steps < <(tail -n 5 "$log" | sed -nE 's|^\[([0-9]+)/([0-9]+)\].*|\1 \2|p' | tail -n 1) || continue
    say "compiling ($preset): $done_steps of $all_steps steps, about $(((SECONDS - began) * (all_steps - done_steps) / (done_steps + 1) / 60 + 1)) min left"
  done
}

# build PRESET TARGET...: ninja's own progress line on a terminal, a line every 30 s elsewhere, the errors when it fails.
build() {
  local preset=$1 pid
  shift
  local log="$root/build/build-$preset.log"
  if [ -t 2 ]; then
    cmake --build "$root/build/$preset" -j "$(build_jobs)" --target "$@" >&2 && return 0
  else
    ${build_limit_s:+timeout "$build_limit_s"} cmake --build "$root/build/$preset" -j "$(build_jobs)" --target "$@" >"$log" 2>&1 &
    pid=$!
    told_every 30 "$pid" "$preset" "$log"
    wait "$pid" && return 0
    grep -E -A 12 'error:|FAILED' "$log" | head -n 80 >&2 || tail -n 40 "$log" >&2
  fi
  say "the build of $* ($preset) failed${log:+; the whole output: $log}"
  return 3
}

# programs_are_current [FOR]: whether no source is newer than the last complete build of the programs, or of those FOR a scenario.
programs_are_current() {
  local stamp="$root/build/release/.programs_built${1:+_for_$1}"
  [ -x "$root/build/release/bin/gridspace${1:+-runner}" ] && [ -f "$stamp" ] || return 1
  [ -z "$(find "$root" -path "$root/build" -prune -o -path "$root/.git" -prune -o -path "$root/runs" -prune -o -path "*/node_modules" -prune -o \
    -path "$root/tests" -prune -o -path "$root/docs" -prune -o -path "$root/configs" -prune -o \
    \( -name '*.cpp' -o -name '*.hpp' -o -name '*.idl' -o -name '*.in' -o -name '*.cmake' -o -name 'CMake*' -o -name '*.ts' -o -name '*.tsx' -o -name '*.css' -o -name '*.html' -o -name '*.js' \) \
    -newer "$stamp" -print -quit)" ]
}

# ensure_programs: the programs of the release preset, installed packages and all. Quick when there is nothing to do.
ensure_programs() { ensure_programs_for ""; }

# ensure_programs_for SCENARIO: only gridspace-runner and what SCENARIO needs, which takes half the time; everything where it is empty.
ensure_programs_for() {
  local scenario=$1 for=""
  [ -z "$scenario" ] || for=$(readlink -f "$scenario" | md5sum | cut -c1-16)
  programs_are_current "$for" && return 0
  if [ ! -w "$root" ] || { [ -e "$root/build" ] && [ ! -w "$root/build" ]; }; then
    [ -x "$root/build/release/bin/gridspace" ] && return 0 # somebody else's tree: use what they built
    say "$root is not writable for you and holds no build"
    return 3
  fi
  ensure_packages build || return
  # Without Node the monitor serves a plain page: worth a try, not worth a failure.
  ensure_packages dashboard || say "going on without the dashboard: the monitor serves a plain page"
  mkdir -p "$root/build"
  (
    flock 9
    programs_are_current "$for" && exit 0
    first=$([ -x "$root/build/release/bin/gridspace" ] || echo yes)
    [ -z "$first" ] || say "building what ${scenario:-Gridspace} needs: once, some minutes"
    began=$(mktemp "$root/build/.began.XXXX")
    if [ ! -f "$root/build/release/.configured" ]; then
      configure release -DGRIDSPACE_TESTS=OFF || exit
    fi
    if [ -n "$for" ]; then
      build release gridspace-runner || exit
      mapfile -t needed < <("$root/build/release/bin/gridspace-runner" run --programs "$scenario" 2>/dev/null)
      # What cannot be read is for the launcher to complain about.
      [ ${#needed[@]} -eq 0 ] || build release "${needed[@]}" || exit
      mv "$began" "$root/build/release/.programs_built_for_$for"
      say "built: what $scenario needs"
      exit 0
    fi
    build release programs || exit
    mv "$began" "$root/build/release/.programs_built"
    [ -z "$first" ] || say "built: $root/build/release/bin"
  ) 9>"$root/build/.lock"
}
