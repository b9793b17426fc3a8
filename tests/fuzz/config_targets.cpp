// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "targets.hpp"

#include <cstdlib>
#include <string_view>

namespace gridspace::fuzz {

void yaml(std::uint8_t const* data, std::size_t size) {
    using namespace config;
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    Diagnostics diagnostics;
    auto const root = parse_yaml(text, make_source("f.yaml", text), diagnostics);
    (void)diagnostics.render();
    if (!root || !diagnostics.ok()) {
        return;
    }
    if (root->is_map()) {
        Node merged = *root;
        merge(merged, *root);
        resolve_likes(merged, diagnostics);
        apply_set(merged, std::string{text.substr(0, 64)}, 1, diagnostics);
    }
    std::string const printed = to_yaml(*root);
    Diagnostics again;
    auto const back = parse_yaml(printed, make_source("g.yaml", printed), again);
    if (!back || !again.ok() || to_yaml(*back) != printed) {
        std::abort(); // what is written as scenario.resolved.yaml must read back
    }
}

} // namespace gridspace::fuzz
