// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/emt/topology.hpp"

#include <utility>
#include <vector>

namespace gridspace::sim::emt {

/// The elements at the nodes of one part of the unknowns (Division), in the order of the circuit. Each element is in
/// one share; each end of a travelling-wave line is an element of its own.
struct Share {
    struct Branches {
        std::vector<int> index, from, to; ///< of the element; three slots each
        /// By element: its nodes follow each other, and its other end is earth. Most are such, and cost half.
        std::vector<unsigned char> shunt;
    };
    struct Terminals {
        std::vector<int> index, slots; ///< three slots each; four of windings and cores
    };
    Branches rl, capacitors, coupled;
    Terminals windings, cores, wave_ends /* 2 line + end */, marti_ends, injections, norton;
    std::vector<Entry<double>> coupling; ///< to source nodes
};

/// Who adds what to a right-hand side, where that belongs to none of the shares: an entry of the histories of a kind of
/// element (HistoryKind), in the order in which one share would add them.
enum class HistoryKind { rl, capacitor, coupled, winding, core, wave, marti, injection, voltage, norton };
constexpr std::size_t kHistoryKinds = 10;
struct RestEntry {
    int row{0};
    HistoryKind kind{HistoryKind::rl};
    int at{0};
    double factor{1};
};

struct Shares {
    std::vector<Share> parts;
    std::vector<RestEntry> rest;
    std::vector<std::pair<int, int>> rest_norton; ///< row, entry of the corrections
};

/// What an element connects, among unknowns: it reads and changes these together.
[[nodiscard]] std::vector<std::pair<int, int>> element_ties(Circuit const& circuit, Topology const& topology);

[[nodiscard]] Shares make_shares(Circuit const& circuit, Topology const& topology,
                                 std::vector<Entry<double>> const& coupling, Division const& division);

} // namespace gridspace::sim::emt
