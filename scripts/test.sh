#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace test [--all] [--only TIER]: what a contributor runs before a change, and with --all what CI runs.
# shellcheck disable=SC2317 # the tiers are called by name
# Each tier is a function of this file; every tier runs even when an earlier one failed; the table at the end tells all.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

contributor_tiers=(lint build unit integration scenarios)
all_tiers=("${contributor_tiers[@]}" e2e arm64 sanitizers fuzz coverage tidy)

usage() {
  cat <<'EOF'
usage: ./gridspace test [--all] [--only TIER[,TIER...]]
  lint         scripts and file conventions
  build        the release preset with its tests
  unit         unit and property tests
  integration  real processes, DDS, namespaces and frames
  scenarios    the scenarios of configs/ as tests, compared from run to run
with --all also
  e2e          the dashboard on live and recorded runs, in headless Chromium
  arm64        cross-compiled for ARM64: unit tests and scenarios in emulation
  sanitizers   unit tests and a scenario under ASan and UBSan (clang)
  fuzz         every fuzz target for a short while
  coverage     lines of the frame decoder that unit tests and kept corpus run through
  tidy         clang-tidy on the files that changed since the last commit of main
EOF
}

# run_ctest PRESET arguments...: CTest with the counts that the table needs in ctest_note.
run_ctest() {
  local preset=$1 log status=0
  shift
  log="$root/build/ctest-$preset-${tier}.log"
  ctest --test-dir "$root/build/$preset" --output-on-failure --no-tests=error --timeout 300 "$@" >"$log" 2>&1 || status=$?
  local total failed skipped
  total=$(sed -n 's/^\([0-9]*\)% tests passed, \([0-9]*\) tests\? failed out of \([0-9]*\).*/\3/p' "$log")
  failed=$(sed -n 's/^\([0-9]*\)% tests passed, \([0-9]*\) tests\? failed out of \([0-9]*\).*/\2/p' "$log")
  skipped=$(grep -c '\*\*\*Skipped' "$log")
  note="${total:-0} tests, ${failed:-all} failed, $skipped skipped"
  if [ "$status" -ne 0 ]; then
    grep -vE '^ *[0-9]+/[0-9]+ Test +#.*Passed|^ +Start +[0-9]+:' "$log" | head -n 200
    echo "the whole output: $log"
  fi
  # A skip would hide what this machine cannot do: CI counts it as a failure, but for the few with a stated reason.
  if [ "$skipped" -ne 0 ]; then
    local unexpected
    unexpected=$(sed -nE 's/.*Test +#[0-9]+: ([^ ]+) \.*\*\*\*Skipped.*/\1/p' "$log" | grep -vxFf <(awk '!/^#/ {print $1}' "$root/tests/allowed_skips.txt"))
    printf 'skipped: %s\n' "$(sed -nE 's/.*Test +#[0-9]+: ([^ ]+) \.*\*\*\*Skipped.*/\1/p' "$log" | tr '\n' ' ')"
    [ -z "$everything" ] || [ -z "$unexpected" ] || { echo "not expected to be skipped: $unexpected"; status=1; }
  fi
  return "$status"
}

tier_lint() { python3 "$root/tests/lint/lint.py"; }

tier_build() { configure release -DGRIDSPACE_TESTS=ON && build release all && touch "$root/build/release/.programs_built"; }

tier_unit() { run_ctest release -L unit -j "$(nproc)"; }

# The slow ones (real time, emulated boards, two sites) only with --all.
tier_integration() {
  local but=(-LE slow)
  [ -z "$everything" ] || but=()
  run_ctest release -L integration "${but[@]}"
}

tier_scenarios() {
  python3 "$root/tests/scenarios/run_scenarios.py" --gridspace "$root/build/release/bin/gridspace" ${everything:+--all}
}


tier_e2e() {
  local log=$root/build/e2e.log status=0
  (cd "$root/tests/e2e" && npm ci --no-audit --no-fund --loglevel=error && node dashboard.mjs "$root/build/release") >"$log" 2>&1 || status=$?
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

tier_sanitizers() {
  configure asan && build asan all || return
  run_ctest asan -L unit -j "$(nproc)" || return
  local counts=$note
  python3 "$root/tests/scenarios/run_scenarios.py" --gridspace "$root/build/asan/bin/gridspace" --sanitizer || return
  note="$counts; $note"
}

tier_fuzz() { "$root/scripts/fuzz.sh" "${GRIDSPACE_FUZZ_SECONDS:-60}"; }

tier_coverage() {
  local log=$root/build/coverage.log status=0
  "$root/scripts/coverage.sh" >"$log" 2>&1 || status=$?
  note=$(sed -n 's/^together *//p' "$log")
  [ "$status" -eq 0 ] || cat "$log"
  return "$status"
}

tier_tidy() { "$root/scripts/tidy.sh"; }

everything=""
tiers=("${contributor_tiers[@]}")
while [ $# -gt 0 ]; do
  case $1 in
    --all)
      everything=yes tiers=("${all_tiers[@]}")
      export GRIDSPACE_TEST_ALL=1 # an outside judge that is missing is a failure, not a skip
      ;;
    --only)
      shift
      IFS=, read -r -a tiers <<<"${1:?--only needs a tier}"
      ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
  esac
  shift
done
for tier in "${tiers[@]}"; do
  declare -F "tier_$tier" >/dev/null || { say "there is no tier '$tier'"; usage >&2; exit 2; }
done

case " ${tiers[*]} " in
  *" build "*) ;;
  *" unit "* | *" integration "* | *" scenarios "* | *" e2e "*)
    if [ ! -e "$root/build/release/.programs_built" ] || ! grep -qs '^GRIDSPACE_TESTS:.*=ON' "$root/build/release/CMakeCache.txt"; then
      say "the tests are not built here yet: the tier 'build' is added"
      tiers=(build "${tiers[@]}")
    fi
    ;;
esac

groups=(build dashboard test)
case " ${tiers[*]} " in *" sanitizers "* | *" fuzz "* | *" tidy "*) groups+=(all) ;; esac
case " ${tiers[*]} " in *" e2e "*) groups+=(e2e) ;; esac
ensure_packages "${groups[@]}" || exit
mkdir -p "$root/build"
exec 8>"$root/build/.test_lock"
flock -n 8 || { say "another ./gridspace test is running in this tree; waiting for it"; flock 8; }

rows=() worst=0
for tier in "${tiers[@]}"; do
  printf '\n== %s\n' "$tier"
  note="" began=$SECONDS verdict=passed
  "tier_$tier" || { verdict=FAILED worst=1; }
  rows+=("$(printf '%-12s %-7s %5d s  %s' "$tier" "$verdict" $((SECONDS - began)) "$note")")
  echo "${rows[-1]}"
  [ "$tier/$verdict" != build/FAILED ] || { say "nothing to test without a build"; break; }
done
printf '\n== summary\n'
printf '%s\n' "${rows[@]}"
printf 'total %d s\n' "$SECONDS"
exit "$worst"
