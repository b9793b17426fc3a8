// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/circuit.hpp"
#include "sim/components/faces/ride_through.hpp"
#include "sim/network/network.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::sim::emt {

/// Where the elements of a network are in its circuit.
struct NetworkCircuit {
    /// Poles, and what an element at one bus has behind them; -1: not there.
    struct OnePortParts {
        std::size_t bus{0};
        int node{0}, breaker{0};
        int resistance{-1}, inductance{-1}, capacitance{-1}; ///< of the star: rl, rl, capacitor branch
        int injection{-1};
        int source{-1}, impedance{-1}; ///< ideal source, and the rl branch from there to the node
        int norton{-1};
    };
    /// A grid-following current: a converter, or what a load draws beyond a constant impedance.
    struct Injection {
        std::size_t bus{0};
        int node{0}, breaker{0};
        double max_peak_a{0};
        double filter_kvar{0};            ///< what its filter gives at nominal voltage
        bool by_phase{false};             ///< holds powers phase by phase, not of the positive sequence
        std::optional<GridRules> rules{}; ///< of a source: it gives nothing where no grid holds its bus
        bool shows_share{false};          ///< they are configured: its share of the current is a signal
        std::unique_ptr<PowerModel> model;
    };

    Circuit circuit;
    std::vector<int> bus_node;
    std::vector<double> bus_peak_v;                    ///< nominal, phase to earth
    std::vector<TwoPortParts> two_ports;               ///< in the order of two_ports(network)
    std::vector<OnePortParts> one_ports;               ///< in the order of one_ports(network)
    std::vector<Injection> injections;                 ///< in the order of the circuit's
    std::vector<int> line_switch;                      ///< by switch at a line's end
    std::map<std::string, std::vector<int>> terminals; ///< switches that take an element out of service, by its name
};

/// The circuit of a network, in SI units; profiles begin at `start_hour_of_day`. Fails on elements that the waveform
/// solver has no model for.
[[nodiscard]] Result<NetworkCircuit> make_circuit(Network const& network, double start_hour_of_day);

/// Ohm or henry: an element without power conducts nothing, but can be given power later.
constexpr double kNothing = 1e18;

/// Star impedances of an admittance (kVA at nominal voltage): resistance, and inductance or capacitance, in parallel.
struct StarElements {
    double r_ohm{0}, l_h{0}, c_f{0};
};
[[nodiscard]] StarElements star_elements(Complex admittance_kva, double voltage_v, double frequency_hz);

} // namespace gridspace::sim::emt
