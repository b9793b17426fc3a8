// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace router CONFIG: gridspace-router takes the place of this process.
#include "launcher/cli/become.hpp"
#include "launcher/cli/verbs.hpp"

#include <string>
#include <utility>
#include <vector>

namespace gridspace::cli {

int router(RouterArguments const& arguments) {
    std::vector<std::string> words{"--config", arguments.config.string()};
    if (arguments.check) {
        words.emplace_back("--check");
    }
    if (arguments.json) {
        words.emplace_back("--json");
        words.emplace_back("--log-level");
        words.emplace_back("warning");
    }
    return become("gridspace-router", "router", std::move(words));
}

} // namespace gridspace::cli
