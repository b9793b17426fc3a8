// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/opendss/solve.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <string>

namespace gridspace::opendss {

/// Scripts that lie in memory: by "folder/name".
using Files = std::map<std::string, std::string>;

inline ReadDssFile reader_of(Files const& files) {
    return [files](std::string const& folder, std::string const& path) -> Result<DssFile> {
        std::string const whole = folder.empty() ? path : folder + "/" + path;
        auto const it = files.find(whole);
        if (it == files.end()) {
            return fail(ExitCode::usage, fmt::format("there is no file '{}'", whole));
        }
        std::size_t const slash = whole.rfind('/');
        return DssFile{it->second, whole, slash == std::string::npos ? "" : whole.substr(0, slash)};
    };
}

inline Script script_of(std::string const& text, config::Diagnostics& diagnostics, Files const& files = {}) {
    return run_script({text, "main.dss", ""}, reader_of(files), diagnostics);
}

/// A circuit that must be right, and its solution.
struct Solved {
    Circuit circuit;
    CircuitFlow flow;

    /// Voltage to earth of a node of a bus.
    [[nodiscard]] Complex v(std::string const& bus, int node) const {
        auto const place = circuit.find_bus(bus);
        return place ? flow.v[circuit.buses[*place].nodes.at(node)] : Complex{};
    }
    [[nodiscard]] double pu(std::string const& bus, int node) const {
        return std::abs(v(bus, node)) / (flow.bus_base_kv[*circuit.find_bus(bus)] * 1e3 / std::sqrt(3.0));
    }
};

inline double degrees(Complex x) {
    return std::arg(x) * 180 / std::numbers::pi;
}

inline Solved solved(std::string const& text) {
    config::Diagnostics diagnostics;
    Script const script = script_of(text, diagnostics);
    auto circuit = build_circuit(script, diagnostics);
    EXPECT_TRUE(circuit.has_value()) << diagnostics.render();
    if (!circuit) {
        return {};
    }
    auto flow = solve_circuit(*circuit);
    EXPECT_TRUE(flow.has_value()) << (flow ? "" : describe(flow.error()));
    return flow ? Solved{std::move(*circuit), std::move(*flow)} : Solved{};
}

/// What is wrong with a script, as a user reads it.
inline std::string mistakes(std::string const& text, Files const& files = {}) {
    config::Diagnostics diagnostics;
    Script const script = script_of(text, diagnostics, files);
    (void)build_circuit(script, diagnostics);
    return diagnostics.render();
}

} // namespace gridspace::opendss
