// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sim/network/matlab_case.hpp"
#include "targets.hpp"

#include <string_view>

namespace gridspace::fuzz {

void matlab_case(std::uint8_t const* data, std::size_t size) {
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    config::Diagnostics diagnostics;
    (void)sim::read_matlab_case(text, config::make_source("c.m", text), diagnostics);
    (void)diagnostics.render();
}

} // namespace gridspace::fuzz
