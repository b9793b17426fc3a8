#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/fuzz.sh [SECONDS [TARGET...]]: every libFuzzer target (or those) for so long each (default 60), in seconds of a processor, so
# that a loaded machine does not shorten it; at most five times that on the clock. As many at once as there are processors
# (GRIDSPACE_FUZZ_AT_ONCE), beginning with the corpus that is kept in tests/fuzz/corpus. What it finds is in build/asan/findings and fails
# the command. GRIDSPACE_FUZZER: a fuzzer that is built already.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

seconds=${1:-60}
shift
fuzzer=${GRIDSPACE_FUZZER:-$root/build/asan/tests/gridspace-fuzz}
[ -n "${GRIDSPACE_FUZZER:-}" ] || { ensure_packages build test all && configure asan -DGRIDSPACE_TESTS=ON && build asan gridspace-fuzz; } || exit
at_once=${GRIDSPACE_FUZZ_AT_ONCE:-$(nproc)}
findings=$root/build/asan/findings
mkdir -p "$findings"

# used_s PID: seconds of a processor that it has used.
used_s() { ps -o cputimes= -p "$1" 2>/dev/null | tr -d ' '; }

run_target() {
  local name=$1 corpus=$root/tests/fuzz/corpus/$1 fresh fuzzing used=0 said=0
  [ -d "$corpus" ] || { echo "$name FAILED: there is no corpus in tests/fuzz/corpus/$name"; return 1; }
  fresh=$(mktemp -d)
  ASAN_OPTIONS=detect_leaks=1 "$fuzzer" "$name" -max_total_time=$((5 * seconds)) -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$findings/$name-" "$fresh" "$corpus" >"$findings/$name.log" 2>&1 &
  fuzzing=$!
  while [ "${used:-$seconds}" -lt "$seconds" ]; do
    sleep 1
    used=$(used_s "$fuzzing")
    said=${used:-$said}
  done
  kill -USR1 "$fuzzing" 2>/dev/null # libFuzzer ends and says what it did
  if wait "$fuzzing"; then
    printf '%-24s ok, %s inputs in %s s of a processor, %s edges\n' "$name" "$(sed -n 's/stat::number_of_executed_units: *//p' "$findings/$name.log")" \
      "$said" "$(grep -o 'cov: [0-9]*' "$findings/$name.log" | tail -n 1 | cut -c6-)"
  else
    printf '%-24s FAILED, see %s\n' "$name" "$findings/$name.log"
    tail -n 30 "$findings/$name.log"
    return 1
  fi
  rm -rf "$fresh"
}

[ $# -gt 0 ] || mapfile -t targets < <("$fuzzer")
[ $# -eq 0 ] || targets=("$@")
[ "${#targets[@]}" -gt 0 ] || { say "there is no fuzz target"; exit 1; }
failed=0 running=0
for name in "${targets[@]}"; do
  run_target "$name" &
  running=$((running + 1))
  if [ "$running" -ge "$at_once" ]; then
    wait -n || failed=1
    running=$((running - 1))
  fi
done
while [ "$running" -gt 0 ]; do
  wait -n || failed=1
  running=$((running - 1))
done
exit "$failed"
