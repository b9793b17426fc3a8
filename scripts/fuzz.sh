#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/fuzz.sh [SECONDS]: every libFuzzer target for so long each (default 60), on the corpus that is kept in tests/fuzz/corpus.
# What it finds is written to build/fuzz/findings and fails the command.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

seconds=${1:-60}
ensure_packages build all || exit
configure fuzz -DGRIDSPACE_TESTS=ON && build fuzz fuzz_targets || exit
findings="$root/build/fuzz/findings"
mkdir -p "$findings"
failed=0 count=0
run_target() {
  local target=$1 name
  name=$(basename "$target")
  local corpus="$root/tests/fuzz/corpus/${name#fuzz_}" fresh
  fresh=$(mktemp -d)
  mkdir -p "$corpus"
  if ASAN_OPTIONS=detect_leaks=1 "$target" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=2048 -print_final_stats=1 \
    -artifact_prefix="$findings/$name-" "$fresh" "$corpus" >"$findings/$name.log" 2>&1; then
    printf '%-24s ok, %s runs\n' "$name" "$(sed -n 's/stat::number_of_executed_units: *//p' "$findings/$name.log")"
  else
    printf '%-24s FAILED, see %s\n' "$name" "$findings/$name.log"
    tail -n 30 "$findings/$name.log"
    return 1
  fi
  rm -rf "$fresh"
}
for target in "$root"/build/fuzz/fuzz/fuzz_*; do
  [ -x "$target" ] || continue
  count=$((count + 1))
  run_target "$target" & # two at a time: as many as this machine's processors, roughly
  if [ $((count % $(nproc))) -eq 0 ]; then for job in $(jobs -p); do wait "$job" || failed=1; done; fi
done
for job in $(jobs -p); do wait "$job" || failed=1; done
[ "$count" -gt 0 ] || { say "no fuzz target was built"; exit 1; }
exit "$failed"
