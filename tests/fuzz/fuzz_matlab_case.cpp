// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Any text is read as a MATPOWER case.
#include "common/config/yaml.hpp"
#include "sim/network/matlab_case.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    using namespace gridspace;
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    config::Diagnostics diagnostics;
    (void)sim::read_matlab_case(text, config::make_source("c.m", text), diagnostics);
    (void)diagnostics.render();
    return 0;
}
