#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace arm64 VERB: agents, gateways, recorder and detector for ARM64 boards.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"
# shellcheck source=scripts/arm64_packages.sh
source "$root/scripts/arm64_packages.sh"
# shellcheck source=scripts/arm64_board.sh
source "$root/scripts/arm64_board.sh"

usage() {
  cat <<'EOT'
usage: ./gridspace arm64 VERB
  sysroot    Debian's libraries of ARM64: build/arm64-sysroot
  build      cross-compiles what runs on a board: build/arm64/bin
  image      the same, and the image of an emulated board (`run_on: qemu-system`): build/arm64-board
  measure    code size, memory, start-up and time per sample; --write puts the tables into docs/reference/arm64.md
  test       the same with its unit tests, which run under qemu-user, and the scenarios with emulated processes; then the counts
EOT
}

# Compiler, emulator and the libraries of the target.
prepare() {
  ensure_packages build arm64 || return
  # shellcheck disable=SC2086 # a list of names
  arm64_unpack "$root/build/arm64-sysroot" $arm64_build_packages
}

# The dashboard's tests of the tree apart, these are all unit tests that do not need the simulator, the monitor or the launcher.
# What is left out stands in tests/arm64/left_out.txt; anything else that is missing is a mistake.
check_left_out() {
  local found=$root/build/arm64/tests_left_out.txt
  if ! diff <(awk '!/^#/ {print $1}' "$root/tests/arm64/left_out.txt" | sort) <(awk 'NF {print $1}' "$found" | sort) >&2; then
    say "the test programs that the build for ARM64 leaves out (>) are not those of tests/arm64/left_out.txt (<)"
    return 1
  fi
}

# test: every unit test under qemu-user. Counts on standard output; fails on a failure, and on a skip that is not allowed.
run_unit_tests() {
  local log=$root/build/unit-arm64.log status=0 began=$SECONDS
  python3 "$root/scripts/unit_tests.py" "$root/build/arm64" --emulator "/usr/bin/qemu-aarch64-static -L $root/build/arm64-sysroot" \
    --patience 2400 --allowed-skips "$root/tests/allowed_skips.txt" >"$log" 2>&1 || status=$?
  [ "$status" -eq 0 ] || head -n 200 "$log"
  echo "ARM64 under qemu-user: $(tail -n 1 "$log"), $(grep -c . "$root/build/arm64/tests_left_out.txt") programs left out (tests/arm64/left_out.txt), $((SECONDS - began)) s"
  return "$status"
}

# The scenarios with emulated processes, each compared with its native twin.
run_scenarios() {
  local log=$root/build/arm64-scenarios.log status=0 began=$SECONDS
  python3 "$root/tests/scenarios/run_scenarios.py" --gridspace "$root/build/release/bin/gridspace" --tier arm64 >"$log" 2>&1 || status=$?
  cat "$log"
  echo "ARM64 scenarios: $(tail -n 1 "$log"), $(grep -c identical: "$log") compared as identical, $((SECONDS - began)) s"
  return "$status"
}

# Bundles for boards, and what is said about mistakes.
run_bundle_tests() {
  local log=$root/build/arm64-bundle.log status=0
  GRIDSPACE=$root/build/release/bin/gridspace python3 "$root/tests/arm64/bundle_test.py" >"$log" 2>&1 || status=$?
  [ "$status" -eq 0 ] || cat "$log"
  echo "ARM64 bundles and mistakes: $(grep '^Ran ' "$log"), $(tail -n 1 "$log")"
  return "$status"
}

case ${1:-} in
  sysroot) prepare ;;
  image)
    prepare && configure arm64 -DGRIDSPACE_TESTS=ON && build arm64 programs && make_board_image
    ;;
  build)
    prepare && configure arm64 -DGRIDSPACE_TESTS=ON && build arm64 programs && say "built: $root/build/arm64/bin"
    ;;
  test)
    prepare && configure arm64 -DGRIDSPACE_TESTS=ON && build arm64 all && check_left_out && make_board_image || exit
    ensure_programs || exit
    worst=0
    run_unit_tests || worst=1
    run_bundle_tests || worst=1
    run_scenarios || worst=1
    exit "$worst"
    ;;
  measure)
    prepare && configure arm64 -DGRIDSPACE_TESTS=ON && build arm64 programs sample_cost && make_board_image || exit
    ensure_programs && build release sample_cost || exit
    shift
    exec python3 "$root/tests/arm64/measure.py" "$@"
    ;;
  '' | -h | --help) usage ;;
  *)
    say "arm64 has no verb '$1'"
    usage >&2
    exit 2
    ;;
esac
