#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace test [--all | --long] [--only TIER]: what a contributor runs before a change, what CI runs, and what takes hours.
# Every tier runs even when an earlier one failed; the table at the end shows all.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"
# shellcheck source=scripts/tiers.sh
source "$root/scripts/tiers.sh"

contributor_tiers=(lint build unit integration scenarios)
all_tiers=("${contributor_tiers[@]}" slow more_scenarios e2e arm64 sanitizers fuzz coverage tidy)
long_tiers=(build long_tests long_scenarios long_sanitizers long_fuzz long_soak long_tidy long_packages long_release)

usage() {
  cat <<'EOT'
usage: ./gridspace test [--all | --long] [--only TIER[,TIER...]]
  lint            scripts, layout and file conventions
  build           the release preset with its tests
  unit            unit and property tests
  integration     real processes, DDS, namespaces and frames
  scenarios       the short scenarios of configs/, compared from run to run
with --all also, as CI runs it
  slow            integration tests that take longer: emulated boards, two sites
  more_scenarios  the longer scenarios
  e2e             the dashboard on live and recorded runs, in headless Chromium
  arm64           cross-compiled for ARM64: unit tests and scenarios in emulation
  sanitizers      unit tests and a scenario under ASan and UBSan (clang)
  fuzz            every fuzz target for 12 s (GRIDSPACE_FUZZ_SECONDS)
  coverage        lines of the frame decoder that unit tests and kept corpus run through
  tidy            clang-tidy on what has changed since it was last clean, for two minutes
with --long, by command only
  long_tests      integration tests that take minutes each, among them those in real time
  long_scenarios  all scenarios in real time and the longest in lockstep
  long_sanitizers every short scenario under ASan and UBSan; bus, launcher and threads of waveforms under TSan
  long_fuzz       every fuzz target for ten minutes
  long_packages   the Debian packages: made, installed in a clean Debian 12, used, replaced, removed; containers of them; as root
  long_release    what is published of a version: a tarball, packages made of it twice, the same octets
  long_soak       an hour of protection.yaml in real time, a hundred starts of each scenario beside busy loops
  long_tidy       clang-tidy on everything
EOT
}

everything=""
tiers=("${contributor_tiers[@]}")
while [ $# -gt 0 ]; do
  case $1 in
    --all)
      everything=yes tiers=("${all_tiers[@]}")
      export GRIDSPACE_TEST_ALL=1 # an outside judge that is missing is a failure, not a skip
      ;;
    --long)
      everything=yes tiers=("${long_tiers[@]}")
      export GRIDSPACE_TEST_ALL=1
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

needs() { # needs TIER...: whether one of them will run
  local tier
  for tier in "$@"; do case " ${tiers[*]} " in *" $tier "*) return 0 ;; esac; done
  return 1
}
if ! needs build && needs unit integration scenarios slow more_scenarios e2e arm64 long_tests long_scenarios long_soak &&
  { [ ! -e "$root/build/release/.programs_built" ] || ! grep -qs '^GRIDSPACE_TESTS:.*=ON' "$root/build/release/CMakeCache.txt"; }; then
  say "the tests are not built here yet: the tier 'build' is added"
  tiers=(build "${tiers[@]}")
fi

groups=(build dashboard test)
if needs lint sanitizers fuzz tidy long_sanitizers long_fuzz long_tidy; then groups+=(all); fi
if needs e2e; then groups+=(e2e); fi
if needs long_tests; then groups+=(languages); fi
ensure_packages "${groups[@]}" || exit
mkdir -p "$root/build"
exec 8>"$root/build/.test_lock"
flock -n 8 || { say "another ./gridspace test is running in this tree; waiting for it"; flock 8; }

history=$root/build/test_history.csv # time, commit, tier, verdict, seconds
[ -f "$history" ] || echo "time,commit,tier,verdict,seconds" >"$history"
commit=$(git -C "$root" describe --always --dirty --abbrev=12 2>/dev/null || echo unknown)
times=$(mktemp)
trap 'rm -f "$times"' EXIT

# grown TIER SECONDS: says so when the tier took a quarter and ten seconds more than the last time that it passed.
grown() {
  local before
  before=$(awk -F, -v tier="$1" '$3 == tier && $4 == "passed" { last = $5 } END { print last }' "$history")
  [ -n "$before" ] && [ $(($2 * 4)) -gt $((before * 5)) ] && [ "$2" -gt $((before + 10)) ] && echo "$1 grew from $before to $2 s"
}

# processors: the ticks that all processors have worked and those that they have been there for, since the machine started.
processors() { awk '$1 == "cpu" { print $2 + $3 + $4 + $7 + $8, $2 + $3 + $4 + $5 + $6 + $7 + $8 + $9 }' /proc/stat; }

names=() rows=() seconds=() busy=() growth=() worst=0
for tier in "${tiers[@]}"; do
  printf '\n== %s\n' "$tier"
  note="" began=$SECONDS verdict=passed
  : >"$times"
  read -r worked_before there_before < <(processors)
  "tier_$tier" || { verdict=FAILED worst=1; }
  case $note in 'NOT RUN'*) verdict=NOT_RUN ;; esac
  took=$((SECONDS - began))
  read -r worked there < <(processors)
  if [ "$(wc -l <"$times")" -gt 1 ]; then
    echo "slowest:$(sort -rn "$times" | head -n 20 | awk '$1 >= 1 { printf "%s %s %.0f s", sep, $2, $1; sep = "," }')"
  fi
  names+=("$tier") seconds+=("$took") busy+=($((100 * (worked - worked_before) / (there > there_before ? there - there_before : 1)))) rows+=("$verdict|$note")
  [ "$verdict" != passed ] || mapfile -t -O "${#growth[@]}" growth < <(grown "$tier" "$took")
  echo "$(date -u +%FT%TZ),$commit,$tier,$verdict,$took" >>"$history"
  printf '%-15s %-7s %5d s  %s\n' "$tier" "$verdict" "$took" "$note"
  [ "$tier/$verdict" != build/FAILED ] || { say "nothing to test without a build"; break; }
done

printf '\n== summary\n'
total=0 passed=0 not_run=0
for took in "${seconds[@]}"; do total=$((total + took)); done
for i in "${!names[@]}"; do
  case ${rows[i]} in passed*) passed=$((passed + 1)) ;; NOT_RUN*) not_run=$((not_run + 1)) ;; esac
  printf '%-15s %-7s %5d s %3d %%  busy %3d %%  %s\n' "${names[i]}" "${rows[i]%%|*}" "${seconds[i]}" $((total > 0 ? 100 * seconds[i] / total : 0)) "${busy[i]}" "${rows[i]#*|}"
done
[ "${#growth[@]}" -eq 0 ] || printf '%s\n' "${growth[@]}"
printf 'total %d s (load %s on %s processors; earlier runs: build/test_history.csv)\n' "$SECONDS" "$(cut -d' ' -f1 /proc/loadavg)" "$(nproc)"
printf 'tiers: %d passed, %d failed, %d skipped\n' "$passed" $((${#names[@]} - passed - not_run)) "$not_run"
exit "$worst"
