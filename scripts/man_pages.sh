#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/man_pages.sh BIN OUT VERSION SECONDS [EMULATOR...]: man pages of the programs in the folder BIN from their own --help: OUT/gridspace.1 and
# OUT/gridspace-VERB.1 of the command line, OUT/PROGRAM.8 of what it starts (some of those are called like a verb). SECONDS since 1970 are
# the date in them; EMULATOR runs programs of another architecture.
set -euo pipefail
bin=$1 out=$2 version=$3 emulator=("${@:5}")
export SOURCE_DATE_EPOCH=$4 LC_ALL=C.UTF-8
mkdir -p "$out"

page() { # page NAME SECTION SUMMARY COMMAND
  help2man --no-info --no-discard-stderr --section "$2" --source "Gridspace $version" --manual "Gridspace" --name "$3" --version-string "$1 $version" "$4" |
    awk '$0 == ".IP" { print; print ".nf"; lines = 1; next } lines && /^\./ { print ".fi"; lines = 0 } 1' >"$out/$1.$2" # examples keep their lines
}

for program in "$bin"/gridspace*; do
  name=$(basename "$program")
  help=$("${emulator[@]}" "$program" --help)
  summary=${help%%$'\n'*}
  page "$name" "$([ "$name" = gridspace ] && echo 1 || echo 8)" "${summary#Gridspace: }" "${emulator[*]:+${emulator[*]} }$program"
done
[ -x "$bin/gridspace" ] || exit 0 # a board needs agents only
# The verbs, in groups below the options: "  run                         run a scenario: start, watch, record, judge, report".
"$bin/gridspace" --help | awk -v OFS='\t' '/^[A-Z].*:$/ { verbs = $0 != "Options:" } verbs && /^  [a-z]+  / { verb = $1; sub(/^ +[a-z]+ +/, ""); print verb, $0 }' |
  while IFS=$'\t' read -r verb summary; do
    page "gridspace-$verb" 1 "$summary" "$bin/gridspace $verb"
  done
