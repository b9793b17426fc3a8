// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace gridspace::cli {

/// `gridspace bundle SCENARIO PROCESS`: one process of a scenario as a tarball and a Debian package, for a board.
void add_bundle_verb(CLI::App& app, std::function<int()>& action);

} // namespace gridspace::cli
