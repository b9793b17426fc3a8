// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/emt/circuit.hpp"
#include "sim/network/network.hpp"

#include <map>
#include <memory>
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
    /// Poles, and impedances to earth behind them.
    struct OnePortParts {
        std::size_t bus{0};
        int node{0}, breaker{0};
        int resistance{-1}, inductance{-1}, capacitance{-1}; ///< of the star: rl, rl, capacitor branch
        int injection{-1};
    };
    /// A grid-following current: a converter, or what a load draws beyond a constant impedance.
    struct Injection {
        std::size_t bus{0};
        int node{0}, breaker{0};
        double max_peak_a{0};
        double filter_kvar{0}; ///< what its filter gives at nominal voltage
        bool by_phase{false};  ///< holds powers phase by phase, not of the positive sequence
        bool ceases{false};    ///< gives nothing where no grid holds its bus
        std::unique_ptr<PowerModel> model;
    };
    struct SourceParts {
        int source{0};
        int impedance{-1}; ///< rl branch from the ideal source to the terminal
        int breaker{0};
    };
    struct GeneratorParts {
        int breaker{0};
        int injection{-1}; ///< of a converter; -1: an ideal source
        int source{-1};    ///< that
    };
    struct MachineParts {
        int breaker{0};
    };
    struct TransformerParts {
        int from_switch{0}, to_switch{0};
        int limbs{0}; ///< the first of three windings that hold its ratio
    };

    Circuit circuit;
    std::vector<int> bus_node;
    std::vector<double> bus_peak_v; ///< nominal, phase to earth
    std::vector<LineParts> lines;
    std::vector<OnePortParts> one_ports; ///< in the order of one_ports(network)
    std::vector<SourceParts> sources;
    std::vector<GeneratorParts> generators;
    std::vector<MachineParts> machines;
    std::vector<TransformerParts> transformers;
    std::vector<Injection> injections;                 ///< in the order of the circuit's
    std::vector<int> breaker_switch;                   ///< by breaker
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
