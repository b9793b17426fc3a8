#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# A program and its libraries for a board that is reached over ssh (used by `gridspace run` for `run_on: ssh:HOST`):
#   stage_program.sh ARCH PROGRAM CABLE ROOT STAGE
# Fills STAGE with bin/ and lib/, and prints a name for exactly these files.
set -eu
# shellcheck source=scripts/board/stage.sh
. "$(dirname "$(readlink -f "$0")")/stage.sh"
command -v readelf >/dev/null || fail "the program readelf is missing" "apt install binutils"
of_arch "$1"
mkdir -p "$5/bin" "$5/lib"
collect "$2" "$4" "$5/lib"
for program in "$2" "$3"; do strip_to "$program" "$5/bin/$(basename "$program")"; done
name=$(cd "$5" && find . -type f -exec sha256sum {} + | LC_ALL=C sort -k 2 | sha256sum | cut -c 1-16)
echo "$(basename "$2")-$name"
