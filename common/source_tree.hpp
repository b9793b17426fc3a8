// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

// Where this build came from. Only source_tree.cpp is compiled with these paths, so that the objects of two clones are
// the same.
namespace gridspace {

/// The path of a file of the project, "configs/networks/smib.yaml" for example. It may not exist any more where the
/// program is installed.
std::string source_tree(std::string_view file);

/// The path of a file of the build folder, "bin/gridspace-sim" for example.
std::string build_tree(std::string_view file);

} // namespace gridspace
