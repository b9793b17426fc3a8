// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sim/network/matlab_case.hpp"
#include "sim/network/network_config.hpp"
#include "sim/opendss/solve.hpp"
#include "targets.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::fuzz {

void matlab_case(std::uint8_t const* data, std::size_t size) {
    std::string_view const text{reinterpret_cast<char const*>(data), size};
    config::Diagnostics diagnostics;
    (void)sim::read_matlab_case(text, config::make_source("c.m", text), diagnostics);
    (void)diagnostics.render();
}

void dss(std::uint8_t const* data, std::size_t size) {
    std::string_view rest{reinterpret_cast<char const*>(data), size};
    std::vector<std::string> files; // the script, then "0", "1", …
    while (!rest.empty() && files.size() < 8) {
        std::size_t const end = std::min(rest.find('\0'), rest.size());
        files.emplace_back(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    auto const read = [&](std::string const& /*folder*/, std::string const& path) -> Result<opendss::DssFile> {
        std::size_t const n = path.size() == 1 ? static_cast<std::size_t>(path[0] - '0') + 1 : files.size();
        if (n >= files.size()) {
            return fail(ExitCode::usage, "no such file");
        }
        return opendss::DssFile{files[n], path, ""};
    };
    config::Diagnostics diagnostics;
    auto const script = opendss::run_script({files.empty() ? "" : files[0], "main", ""}, read, diagnostics);
    auto circuit = opendss::build_circuit(script, diagnostics, 12.0);
    require(circuit.has_value() || !diagnostics.ok(), "a script was refused without a word");
    if (circuit && circuit->nodes < 200) {
        opendss::CircuitOptions options;
        options.max_iterations = 20;
        circuit->max_control_rounds = 5;
        (void)opendss::solve_circuit(*circuit, options);
    }
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
