#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace docs [--port N | --build | --pictures]: the pages of docs/ as a site in build/docs, served to this machine. Needs no network.
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"

usage() {
  cat <<'EOT'
usage: ./gridspace docs                serves the documentation on http://127.0.0.1:8000, until Ctrl-C
       ./gridspace docs --port 8080    on another port; 0: any that is free
       ./gridspace docs --build        only makes the pages, in build/docs
       ./gridspace docs --pictures     makes the screenshots in docs/images anew, by the tests that open the pages
EOT
}

port=8000 serve=yes pictures=""
while [ $# -gt 0 ]; do
  case $1 in
    --port) port=${2:-} && shift ;;
    --port=*) port=${1#*=} ;;
    --build) serve="" ;;
    --pictures) pictures=yes ;;
    -h | --help) usage && exit 0 ;;
    *) say "docs: unknown option '$1'" && usage >&2 && exit 2 ;;
  esac
  shift || break
done
if ! [[ $port =~ ^[0-9]{1,5}$ ]] || [ "$((10#$port))" -gt 65535 ]; then
  say "docs: --port needs a number from 0 to 65535, found '$port'"
  exit 2
fi

if [ -n "$pictures" ]; then
  # shellcheck source=scripts/build.sh
  source "$root/scripts/build.sh"
  ensure_packages e2e && ensure_programs && "$root/scripts/npm_packages.sh" "$root/tests/e2e" || exit
  cd "$root/tests/e2e"
  exec node dashboard.mjs "$root/build/release" case_2 reports --renew-pictures
fi

ensure_packages docs || exit
log=$(mktemp)
if ! (cd "$root" && mkdocs build --strict --clean) >"$log" 2>&1; then
  cat "$log" >&2
  rm -f "$log"
  say "docs: the pages could not be made (above: what mkdocs says)"
  exit 3
fi
rm -f "$log"
say "docs: the pages are in $root/build/docs"
[ -n "$serve" ] || exit 0
exec /usr/bin/python3 "$root/scripts/docs_server.py" "$root/build/docs" "$port"
