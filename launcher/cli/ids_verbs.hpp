// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/cli/verbs.hpp"

/// The verbs of `gridspace ids` for others: their captures, their detectors, data for them.
namespace gridspace::cli {

void add_ids_export(CLI::App& ids, Action& action);
void add_ids_scan(CLI::App& ids, Action& action);
void add_ids_score(CLI::App& ids, Action& action);
void add_ids_sweep(CLI::App& ids, Action& action); ///< in sweep_verb.cpp

} // namespace gridspace::cli
