// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/cli/verbs.hpp"

namespace gridspace::cli {

void add_scl_import(Command scl, Action& action); ///< below `scl`

} // namespace gridspace::cli
