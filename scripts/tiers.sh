# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# shellcheck disable=SC2154 # root, tier, everything
# The tiers of the tests, a function each. Sourced by scripts/test.sh, which sets `root` and `tier`. A tier prints what failed, returns
# a status, and leaves a few words for the table in `note` and the times of its tests in the file `times` (seconds, name).

# run_ctest PRESET arguments...: CTest with the counts that the table needs.
run_ctest() {
  local preset=$1 log status=0
  shift
  log="$root/build/ctest-$preset-$tier.log"
  ctest --test-dir "$root/build/$preset" --output-on-failure --no-tests=error --timeout 300 -j "$(nproc)" "$@" >"$log" 2>&1 || status=$?
  local total failed skipped
  total=$(sed -n 's/^\([0-9]*\)% tests passed, \([0-9]*\) tests\? failed out of \([0-9]*\).*/\3/p' "$log")
  failed=$(sed -n 's/^\([0-9]*\)% tests passed, \([0-9]*\) tests\? failed out of \([0-9]*\).*/\2/p' "$log")
  skipped=$(grep -c '\*\*\*Skipped' "$log")
  note="${total:-0} tests, ${failed:-all} failed, $skipped skipped"
  sed -nE 's/^ *[0-9]+\/[0-9]+ +Test +#[0-9]+: ([^ ]+) .* ([0-9.]+) sec.*/\2 \1/p' "$log" >>"$times"
  if [ "$status" -ne 0 ]; then
    grep -vE '^ *[0-9]+/[0-9]+ Test +#.*Passed|^ +Start +[0-9]+:' "$log" | head -n 200
    echo "the whole output: $log"
  fi
  [ "$status" -eq 0 ] || [ -z "${unsteady_may_be:-}" ] || [ -z "$everything" ] || { second_time "$preset" "${failed:-99}" && status=0; }
  # A skip would hide what this machine cannot do: CI counts it as a failure, but for the few with a stated reason.
  if [ "$skipped" -ne 0 ]; then
    local unexpected
    unexpected=$(sed -nE 's/.*Test +#[0-9]+: ([^ ]+) \.*\*\*\*Skipped.*/\1/p' "$log" | grep -vxFf <(awk '!/^#/ {print $1}' "$root/tests/allowed_skips.txt"))
    printf 'skipped: %s\n' "$(sed -nE 's/.*Test +#[0-9]+: ([^ ]+) \.*\*\*\*Skipped.*/\1/p' "$log" | tr '\n' ' ')"
    [ -z "$everything" ] || [ -z "$unexpected" ] || { echo "not expected to be skipped: $unexpected"; status=1; }
  fi
  return "$status"
}

# second_time PRESET FAILED: of tests with many processes, at most two that failed run once more, alone. What then passes does not
# stop CI, but is named in the table: an unsteady test is a mistake to be mended, of the test or of what it tests.
second_time() {
  local log=$root/build/ctest-$1-$tier-second.log names
  [ "$2" -le 2 ] || return 1
  echo "failed tests run once more, alone: $log"
  names=$(sed -nE '/^The following tests FAILED/,$s/^\s+[0-9]+ - (.*) \(.*\)$/\1/p' "$root/build/ctest-$1-$tier.log" | paste -sd' ')
  ctest --test-dir "$root/build/$1" --output-on-failure --no-tests=error --timeout 300 -j 1 --rerun-failed >"$log" 2>&1 || return 1
  note="$note; UNSTEADY, passed the second time: $names"
}

# run_scenarios PRESET options...: the scenarios of configs/ and tests/scenarios as tests.
run_scenarios() {
  local preset=$1 log=$root/build/scenarios-$tier.log status=0
  shift
  python3 "$root/tests/scenarios/run_scenarios.py" --gridspace "$root/build/$preset/bin/gridspace" "$@" >"$log" 2>&1 || status=$?
  note=$(tail -n 1 "$log")
  sed -nE 's/^([^ ]+) +exit .*, ([0-9.]+) s .*/\2 \1/p' "$log" >>"$times"
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_lint() { python3 "$root/tests/lint/lint.py" --self-test && python3 "$root/tests/lint/lint.py"; }

tier_build() { configure release -DGRIDSPACE_TESTS=ON ${everything:+-DGRIDSPACE_BENCH=ON} && build release all && touch "$root/build/release/.programs_built"; }

# run_unit_tests PRESET: the test programs, then the shipped mistakes that validate must find.
run_unit_tests() {
  local preset=$1 log="$root/build/unit-$1.log" status=0
  python3 "$root/scripts/unit_tests.py" "$root/build/$preset" --times "$times" ${everything:+--allowed-skips "$root/tests/allowed_skips.txt"} >"$log" 2>&1 || status=$?
  local programs
  programs=$(tail -n 1 "$log")
  [ "$status" -eq 0 ] && grep '^skipped' "$log"
  [ "$status" -eq 0 ] || head -n 200 "$log"
  run_ctest "$preset" -R '^invalid_configs\.' || status=1
  note="programs: $programs; configurations that are refused: $note"
  return "$status"
}

tier_unit() { run_unit_tests release; }

tier_integration() { unsteady_may_be=yes run_ctest release -L integration -j $((2 * $(nproc))); } # they wait for each other more than they compute

tier_scenarios() { run_scenarios release --tier short; }

tier_slow() { unsteady_may_be=yes run_ctest release -L slow -j $((2 * $(nproc))); }

tier_more_scenarios() { run_scenarios release --tier all; }

tier_e2e() {
  local log=$root/build/e2e.log status=0
  "$root/scripts/npm_packages.sh" "$root/tests/e2e" && (cd "$root/tests/e2e" && node dashboard.mjs "$root/build/release") >"$log" 2>&1 || status=$?
  note="$(grep -c '^ok ' "$log") as expected, $(grep -c '^FAILED' "$log") not; screenshots in tests/e2e/shots"
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_arm64() {
  local log=$root/build/arm64-tier.log status=0
  "$root/scripts/arm64.sh" test >"$log" || status=$?
  note=$(grep '^ARM64' "$log" | sed 's/^ARM64 //' | paste -sd';')
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

build_sanitizers() { configure asan -DGRIDSPACE_TESTS=ON && build asan programs unit_tests gridspace-fuzz; }

# sanitizers_in_time: the same within what is left of CI's time (GRIDSPACE_TEST_BUDGET_S). Compiled from nothing on a slow machine it takes
# longer: the tier is then named as NOT RUN in the table, and the next run goes on from the compiler's cache.
sanitizers_in_time() {
  local build_limit_s=$((${GRIDSPACE_TEST_BUDGET_S:-4600} - SECONDS))
  [ "$build_limit_s" -gt 40 ] || build_limit_s=40
  local before=$SECONDS
  build_sanitizers && return 0
  [ $((SECONDS - before)) -ge "$build_limit_s" ] || return 1
  note="NOT RUN: its build was not ready within ${GRIDSPACE_TEST_BUDGET_S:-4600} s of the start"
  return 2
}

tier_sanitizers() {
  sanitizers_in_time || { [ $? -eq 2 ]; return; }
  run_unit_tests asan || return
  local counts=$note
  run_scenarios asan --sanitizer || return
  note="$counts; $note"
}

tier_fuzz() {
  sanitizers_in_time || { [ $? -eq 2 ]; return; }
  "$root/scripts/fuzz.sh" "${GRIDSPACE_FUZZ_SECONDS:-12}"
}

tier_coverage() {
  local log=$root/build/coverage.log status=0
  "$root/scripts/coverage.sh" >"$log" 2>&1 || status=$?
  note=$(sed -n 's/^together *//p' "$log")
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_tidy() {
  local log=$root/build/tidy.log status=0
  # What is generated of the topics is there when the sanitizers ran before.
  configure asan -DGRIDSPACE_TESTS=ON && build asan gridspace_idl && python3 "$root/scripts/tidy.py" --commits 100 --seconds "${GRIDSPACE_TIDY_SECONDS:-120}" >"$log" 2>&1 || status=$?
  note=$(tail -n 1 "$log")
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_long_tests() { run_ctest release -L long --timeout 7200; }

tier_long_scenarios() { run_scenarios release --tier long; }

tier_long_sanitizers() {
  build_sanitizers && run_scenarios asan --tier short || return
  local counts=$note
  configure tsan -DGRIDSPACE_TESTS=ON && build tsan unit_lockstep unit_realtime unit_bus unit_launcher unit_emt_threads property_lockstep || return
  run_ctest tsan -R '^(unit_lockstep|unit_realtime|unit_bus|unit_launcher|unit_emt_threads|property_lockstep)\.' || return
  note="ASan: $counts; TSan: $note"
}

tier_long_fuzz() { build_sanitizers && "$root/scripts/fuzz.sh" "${GRIDSPACE_FUZZ_SECONDS:-600}"; }

tier_long_packages() {
  "$root/scripts/package.sh" >/dev/null && "$root/scripts/package.sh" --arch arm64 >/dev/null && "$root/scripts/arm64.sh" build >/dev/null || return
  local log=$root/build/packages-tier.log status=0
  "$root/tests/packages/packages_test.sh" >"$log" 2>&1 || status=$?
  note=$(tail -n 1 "$log")
  "$root/tests/packages/container_test.sh" >>"$log" 2>&1 || status=$?
  note="$note; containers: $(tail -n 1 "$log")"
  "$root/tests/packages/arm64_test.sh" >>"$log" 2>&1 || status=$?
  note="$note; $(tail -n 1 "$log")"
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_long_release() {
  local log=$root/build/release-tier.log status=0 out
  out=$(mktemp -d)
  "$root/scripts/release.sh" --draft "$out" >"$log" 2>&1 || status=$?
  note=$(grep -c '\.deb$' "$out/SHA256SUMS" 2>/dev/null)" packages, the same octets twice"
  rm -rf "$out"
  [ "$status" -eq 0 ] || { note="" && cat "$log"; }
  return "$status"
}

tier_long_soak() {
  local log=$root/build/soak.log status=0
  python3 "$root/tests/soak/soak.py" --gridspace "$root/build/release/bin/gridspace" >"$log" 2>&1 || status=$?
  note="$(tail -n 1 "$log"); $log"
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_long_tidy() { configure asan -DGRIDSPACE_TESTS=ON && python3 "$root/scripts/tidy.py"; }
