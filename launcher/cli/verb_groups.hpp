// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/cli/verbs.hpp"

#include <vector>

namespace gridspace::cli {

struct VerbGroup {
    char const* title;
    std::vector<void (*)(Command, Action&)> add;
};

/// The verbs of a program, in the order of its help: those of `gridspace` are in all_verbs.cpp, those of
/// gridspace-runner in runner_verbs.cpp.
std::vector<VerbGroup> verb_groups();

} // namespace gridspace::cli
