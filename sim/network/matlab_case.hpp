// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {

/// A matrix of a case file, with the line where it starts.
struct CaseMatrix {
    std::vector<std::vector<double>> rows;
    int line{0};
    std::vector<int> row_lines; ///< where each row stands; empty when it was computed
};

/// What a MATPOWER case file assigns: `mpc.bus = [...]`, `mpc.baseMVA = 100`, and the arithmetic with which many
/// distribution cases convert ohm and kW to p.u. and MW. Statements beyond that are errors, never skipped.
struct MatlabCase {
    std::map<std::string, CaseMatrix> matrices; ///< "bus", "branch", "gen", …
    std::map<std::string, double> scalars;      ///< "baseMVA", and local variables
    std::string name;                           ///< of the function
};

[[nodiscard]] MatlabCase read_matlab_case(std::string_view text,
                                          std::shared_ptr<config::SourceText const> const& source,
                                          config::Diagnostics& diagnostics);

} // namespace gridspace::sim
