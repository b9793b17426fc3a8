// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/opendss/circuit.hpp"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace gridspace::opendss {

struct CircuitOptions {
    double tolerance_pu{1e-8};
    int max_iterations{1000};
    double hour{0}; ///< of the day, for controls that go by it
};

struct CircuitFlow {
    int iterations{0};     ///< of the last solution
    int control_rounds{0}; ///< solutions, each with the controls where the last had left them
    bool controls_settled{true};
    double change_pu{0};
    Eigen::VectorXcd v;                           ///< V to earth, by node of the circuit
    std::vector<double> bus_base_kv;              ///< line to line, by bus; 0: none was given
    Complex source_va, generated_va, consumed_va; ///< given by sources, given by generators, taken by loads
    Complex losses_va;                            ///< of all elements but the sources
    std::vector<Complex> element_losses_va;       ///< by element
    std::vector<TapWish> regulators;              ///< as they stand at the end
};

/// Power flow of a circuit; its regulators and capacitor controls act first, as OpenDSS's static mode lets them: after
/// each solution those act whose delay is shortest. They leave their taps and states in the circuit.
[[nodiscard]] Result<CircuitFlow> solve_circuit(Circuit& circuit, CircuitOptions const& options = {});

/// Currents into the conductors of an element, A.
[[nodiscard]] Eigen::VectorXcd currents_into(Element const& element, Eigen::VectorXcd const& v);

} // namespace gridspace::opendss
