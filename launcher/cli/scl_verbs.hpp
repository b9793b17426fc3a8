// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace gridspace::cli {

/// Adds `scl` with import and export. `action` is set when one of them was given.
void add_scl_verbs(CLI::App& app, std::function<int()>& action);

} // namespace gridspace::cli
