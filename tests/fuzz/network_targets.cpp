// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sim/network/matlab_case.hpp"
#include "sim/network/network_config.hpp"
#include "targets.hpp"

#include <string_view>

namespace gridspace::fuzz {

void matlab_case(std::uint8_t const* data, std::size_t size) {
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    config::Diagnostics diagnostics;
    (void)sim::read_matlab_case(text, config::make_source("c.m", text), diagnostics);
    (void)diagnostics.render();
}

void network(std::uint8_t const* data, std::size_t size) {
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto const network = root ? sim::read_network(*root, diagnostics) : std::nullopt;
    require(network.has_value() || !diagnostics.ok(), "a network was refused without a word");
    (void)diagnostics.render();
}

} // namespace gridspace::fuzz
