// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/opendss/consumer.hpp"
#include "sim/opendss/controls.hpp"
#include "sim/opendss/dss_script.hpp"
#include "sim/opendss/transformer.hpp"

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::opendss {

struct Bus {
    std::string name;         ///< as it was written first
    std::map<int, int> nodes; ///< of the circuit, by the number of the node at the bus
};

/// A linear element: its conductors, terminal by terminal, and the admittances between them.
struct Element {
    std::string name; ///< "line.650632"
    int conductors{0};
    std::vector<int> nodes;    ///< of each conductor of each terminal; -1: earth
    Eigen::MatrixXcd y;        ///< S; currents into the element
    Eigen::VectorXcd injected; ///< A out of the element at y = 0: what a source drives; empty for the others
    bool in_service{true};     ///< a control may switch it
};

/// An unbalanced circuit of n-phase elements.
struct Circuit {
    std::string name;
    double frequency_hz{60};
    std::vector<Bus> buses;
    int nodes{0};
    std::vector<Element> elements; ///< sources, lines, transformers, capacitors, reactors
    std::vector<Consumer> consumers;
    std::map<std::size_t, Transformer> transformers; ///< by their place in `elements`
    std::vector<Regulator> regulators;
    std::vector<CapacitorControl> capacitor_controls;
    std::vector<double> voltage_bases_kv;      ///< line to line
    std::map<std::string, double> bus_base_kv; ///< line to line, of `setkvbase`, by bus in lower case
    bool controls_act{true};
    int max_control_rounds{100};
    std::vector<LeftOut> left_out;

    [[nodiscard]] std::optional<std::size_t>
    find_element(std::string_view full_name) const;                                ///< "class.name" in lower case
    [[nodiscard]] std::optional<std::size_t> find_bus(std::string_view bus) const; ///< in lower case

    std::map<std::string, std::size_t, std::less<>> element_index, bus_index;
};

/// The circuit that a script describes. `hour` reads daily shapes; without it loads are as they were given.
[[nodiscard]] std::optional<Circuit> build_circuit(Script const& script, config::Diagnostics& diagnostics,
                                                   std::optional<double> hour = {});

} // namespace gridspace::opendss
