// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/emt/circuit.hpp"
#include "sim/network/network.hpp"

#include <map>
#include <string>
#include <vector>

namespace gridspace::sim::emt {

/// Where the elements of a network are in its circuit; vectors go by the element's index in the network.
struct NetworkCircuit {
    struct LineParts {
        struct Section {
            enum class Kind { rl, coupled, wave } kind{Kind::rl};
            int index{0};            ///< of the branch or travelling-wave line
            double start{0}, end{1}; ///< shares of the length
        };
        std::vector<Section> sections; ///< along the line; faults cut them
        int from_node{0}, to_node{0};  ///< on the line side of the breakers
        int from_switch{0}, to_switch{0};
    };
    struct LoadParts {
        /// rl, rl, capacitor branch; -1 for a load by phase or behind a converter
        int resistance{-1}, inductance{-1}, capacitance{-1};
        int node{0}, breaker{0};
    };
    /// A converter, or what a load draws beyond a constant impedance.
    struct Follower {
        enum class Kind { load, dc_load, pv, generator, ev, battery } kind{Kind::load};
        std::size_t element{0}; ///< index in the network's loads, PV, generators, EVs or batteries
        std::size_t bus{0};
        int node{0}, breaker{0};
        double max_peak_a{0};
        double filter_kvar{0}; ///< what its filter gives at nominal voltage
        bool by_phase{false};  ///< holds powers phase by phase, not of the positive sequence
    };
    struct SourceParts {
        int source{0};
        int impedance{-1}; ///< rl branch from the ideal source to the terminal
        int breaker{0};
    };
    struct MachineParts {
        int breaker{0};
    };
    struct TransformerParts {
        int from_switch{0}, to_switch{0};
    };

    Circuit circuit;
    std::vector<int> bus_node;
    std::vector<double> bus_peak_v; ///< nominal, phase to earth
    std::vector<LineParts> lines;
    std::vector<LoadParts> loads, shunts;
    std::vector<SourceParts> sources, slack_generators;
    std::vector<MachineParts> machines;
    std::vector<TransformerParts> transformers;
    std::vector<Follower> followers;                   ///< in the order of the circuit's injections
    std::vector<int> breaker_switch;                   ///< by breaker
    std::map<std::string, std::vector<int>> terminals; ///< switches that take an element out of service, by its name
};

/// The circuit of a network, in SI units. Fails on elements that the waveform solver has no model for.
[[nodiscard]] Result<NetworkCircuit> make_circuit(Network const& network);

/// Star impedances that draw these powers at nominal voltage: resistance, and inductance or capacitance, in parallel.
struct StarElements {
    double r_ohm{0}, l_h{0}, c_f{0};
};
[[nodiscard]] StarElements star_elements(double p_kw, double q_kvar, double voltage_v, double frequency_hz);

} // namespace gridspace::sim::emt
