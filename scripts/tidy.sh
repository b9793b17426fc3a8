#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/tidy.sh [BASE]: clang-tidy on the sources that changed since BASE (default: the commit before this one), at most 24 of them.
set -uo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
cd "$root" || exit 3
base=${1:-HEAD~1}
git rev-parse -q --verify "$base" >/dev/null || base=$(git hash-object -t tree /dev/null)
mapfile -t changed < <(git diff --name-only --diff-filter=d "$base" -- '*.cpp' | grep -vE '^(tests|bench)/')
echo "${#changed[@]} changed source files since $base"
if [ "${#changed[@]}" -gt 24 ]; then
  echo "checking 24 of them; all: scripts/tidy.sh with a nearer base"
  changed=("${changed[@]:0:24}")
fi
[ "${#changed[@]}" -eq 0 ] || printf '%s\n' "${changed[@]}" | xargs -P "$(nproc)" -n 2 clang-tidy-19 -p build/asan --quiet --warnings-as-errors='*' 2>/dev/null
