// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/cli/verbs.hpp"

/// The verbs of `gridspace ids` for others: their captures, their detectors, data for them.
namespace gridspace::cli {

void add_ids_export(Command ids, Action& action);
void add_ids_scan(Command ids, Action& action);
void add_ids_score(Command ids, Action& action);
void add_ids_sweep(Command ids, Action& action); ///< in sweep_verb.cpp

} // namespace gridspace::cli
