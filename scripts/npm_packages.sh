#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# scripts/npm_packages.sh FOLDER [WHERE]: the packages of FOLDER/package-lock.json as WHERE/node_modules (default: FOLDER), a link into
# the cache of the user, where every clone finds them again.
set -euo pipefail
# shellcheck source=scripts/cache.sh
source "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/cache.sh"

wanted=$(readlink -f "$1")
where=${2:-$wanted}
content=$(cat "$wanted/package.json" "$wanted/package-lock.json" <(node --version) | sha256sum | cut -c 1-24)
packages=$(gridspace_cache)/npm/$content

install_into() {
  cp "$wanted/package.json" "$wanted/package-lock.json" "$1/"
  (cd "$1" && npm ci --omit=dev --ignore-scripts --prefer-offline --no-audit --no-fund --loglevel=error >&2)
}
cached "$packages" install_into
[ ! -d "$where/node_modules" ] || [ -L "$where/node_modules" ] || rm -rf "$where/node_modules"
ln -sfn "$packages/node_modules" "$where/node_modules"
