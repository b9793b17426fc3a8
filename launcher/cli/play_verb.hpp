// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace gridspace::cli {

/// gridspace play: samples and frames of a recorded run.
void add_play_verb(CLI::App& app, std::function<int()>& action);

} // namespace gridspace::cli
