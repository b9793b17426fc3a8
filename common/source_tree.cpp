// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"

namespace gridspace {

std::string source_tree(std::string_view file) {
    return std::string{GRIDSPACE_SOURCE_DIR "/"}.append(file);
}

std::string build_tree(std::string_view file) {
    return std::string{GRIDSPACE_BINARY_DIR "/"}.append(file);
}

} // namespace gridspace
