#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/coverage.sh [LEAST_PERCENT]: lines of the decoder (GOOSE, sampled values, BER, MMS data) that the unit tests and the kept
# fuzzing corpus run through. Fails below LEAST_PERCENT (default 95) and prints what was missed.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

ensure_packages build test
configure coverage -DGRIDSPACE_TESTS=ON # the release preset but for the decoder itself: the cache has the rest
build coverage unit_iec61850 fuzz_replay
find "$root/build/coverage" -name '*.gcda' -delete
"$root/build/coverage/tests/unit_iec61850" --gtest_brief=1
"$root/build/coverage/tests/fuzz_replay" --gtest_brief=1
python3 "$root/scripts/coverage.py" --build "$root/build/coverage" --least "${1:-95}" \
  gateways/iec61850/{ber.hpp,octets.hpp,frame.cpp,sv.cpp,goose.cpp,mms_data.cpp,utc_time.hpp}
