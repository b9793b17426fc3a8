#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# ./gridspace bench [MEASURE...] [--rounds N] [--compare COMMIT] [--out FOLDER]: builds the benchmarks and runs them (bench/bench.py).
set -euo pipefail
root=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")
# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"
# shellcheck source=scripts/build.sh
source "$root/scripts/build.sh"

case " $* " in
  *' -h '* | *' --help '*) exec python3 "$root/bench/bench.py" --help ;;
esac
ensure_packages build bench || exit
configure bench && build bench all || exit
exec python3 "$root/bench/bench.py" "$@"
