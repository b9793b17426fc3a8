// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/topology.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace gridspace::sim::emt {
namespace {

/// A short circuit: far below any impedance of a network, far above rounding.
constexpr double kMinFaultOhm = 1e-6;

template <class S>
class Stamper {
  public:
    Stamper(Topology const& t, Assembly<S>& out) : t_{t}, out_{out} {}

    /// One entry of the full matrix; its mirror image is stamped by a call of its own.
    void add(int node_i, int node_j, S g) {
        int const i = t_.slot[static_cast<std::size_t>(node_i)], j = t_.slot[static_cast<std::size_t>(node_j)];
        if (i >= t_.unknowns || g == S{}) {
            return;
        }
        if (j < t_.unknowns) {
            if (i <= j) {
                out_.matrix.push_back({i, j, g});
            }
        } else if (j != t_.earth()) {
            out_.coupling.push_back({i, j, g});
        }
    }

    void between(int a, int b, PhaseMatrixOf<S> const& g) {
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                S const value = g.entry(i, j);
                add(a + i, a + j, value);
                add(b + i, b + j, value);
                add(a + i, b + j, -value);
                add(b + i, a + j, -value);
            }
        }
    }

    void between(int a, int b, Matrix3Of<S> const& g) {
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                S const value = g[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
                add(a + i, a + j, value);
                add(b + i, b + j, value);
                add(a + i, b + j, -value);
                add(b + i, a + j, -value);
            }
        }
    }

    void weighted(std::array<int, 4> const& nodes, std::array<double, 4> const& weights, S g) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                add(nodes[i], nodes[j], weights[i] * weights[j] * g);
            }
        }
    }

  private:
    Topology const& t_;
    Assembly<S>& out_;
};

} // namespace

Result<Topology> make_topology(Circuit const& c, SwitchBits const& bits) {
    std::vector<int> root(static_cast<std::size_t>(c.nodes()));
    std::iota(root.begin(), root.end(), 0);
    auto const top = [&](int i) {
        while (root[static_cast<std::size_t>(i)] != i) {
            i = root[static_cast<std::size_t>(i)] = root[static_cast<std::size_t>(root[static_cast<std::size_t>(i)])];
        }
        return i;
    };
    root[1] = root[2] = 0; // earth is one node
    for (std::size_t s = 0; s < c.switches.size(); ++s) {
        for (int k = 0; k < 3; ++k) {
            if (bits.closed[s][static_cast<std::size_t>(k)]) {
                int const a = top(c.switches[s].outer + k), b = top(c.switches[s].inner + k);
                root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
            }
        }
    }
    Topology t;
    t.slot.assign(root.size(), -1);
    std::vector<int> known(root.size(), -1); // by root: the source node that it is
    known[0] = 0;
    std::vector<std::string> owner(1, "earth");
    for (auto const& source : c.sources) {
        for (int k = 0; k < 3; ++k) {
            auto const r = static_cast<std::size_t>(top(source.node + k));
            if (known[r] >= 0) {
                return fail(
                    ExitCode::usage,
                    fmt::format("closed switches join source '{}' with {}: nothing limits the current between them",
                                source.name, known[r] == 0 ? "earth" : "another ideal source"),
                    "give one of them an impedance, or keep a breaker between them open");
            }
            known[r] = static_cast<int>(owner.size());
            owner.push_back(source.name);
        }
    }
    for (std::size_t i = 0; i < root.size(); ++i) {
        if (top(static_cast<int>(i)) == static_cast<int>(i) && known[i] < 0) {
            t.slot[i] = t.unknowns++;
        }
    }
    for (std::size_t i = 0; i < root.size(); ++i) {
        auto const r = static_cast<std::size_t>(top(static_cast<int>(i)));
        t.slot[i] = known[r] >= 0 ? t.unknowns + known[r] : t.slot[r];
    }
    t.slots = t.unknowns + static_cast<int>(owner.size());
    return t;
}

Conductances fault_conductances(FaultBranch const& fault, std::array<bool, 3> const& on) {
    double const g = 1 / std::max(fault.r_ohm, kMinFaultOhm);
    int const count = static_cast<int>(on[0]) + static_cast<int>(on[1]) + static_cast<int>(on[2]);
    Conductances out{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (on[i] && on[j]) {
                out[i][j] = (i == j ? g : 0) - (fault.earthed ? 0 : g / count);
            }
        }
    }
    return out;
}

template <class S>
Assembly<S> assemble(Circuit const& c, Topology const& topology, SwitchBits const& bits, Admittances<S> const& y) {
    Assembly<S> out;
    Stamper<S> stamp{topology, out};
    for (std::size_t i = 0; i < c.rl.size(); ++i) {
        stamp.between(c.rl[i].from, c.rl[i].to, y.rl[i]);
    }
    for (std::size_t i = 0; i < c.capacitors.size(); ++i) {
        stamp.between(c.capacitors[i].from, c.capacitors[i].to, y.capacitors[i]);
    }
    for (std::size_t i = 0; i < c.coupled.size(); ++i) {
        stamp.between(c.coupled[i].from, c.coupled[i].to, y.coupled[i]);
    }
    for (std::size_t i = 0; i < c.norton.size(); ++i) {
        stamp.between(c.norton[i].node, kEarth, y.norton[i]);
    }
    auto const waves = [&](auto const& lines, auto const& own, auto const& cross) {
        for (std::size_t i = 0; i < lines.size(); ++i) {
            stamp.between(lines[i].from, kEarth, own[i]);
            stamp.between(lines[i].to, kEarth, own[i]);
            for (int a = 0; !cross.empty() && a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                    S const value = cross[i].entry(a, b);
                    stamp.add(lines[i].from + a, lines[i].to + b, value);
                    stamp.add(lines[i].to + b, lines[i].from + a, value);
                }
            }
        }
    };
    waves(c.bergeron, y.bergeron, y.bergeron_cross);
    waves(c.marti, y.marti, y.marti_cross);
    for (std::size_t i = 0; i < c.windings.size(); ++i) {
        stamp.weighted(c.windings[i].nodes, c.windings[i].weights, y.windings[i]);
    }
    for (std::size_t i = 0; i < c.cores.size(); ++i) {
        stamp.weighted(c.cores[i].nodes, c.cores[i].weights, y.cores[i]);
    }
    for (std::size_t i = 0; i < c.faults.size(); ++i) {
        Conductances const g = fault_conductances(c.faults[i], bits.faulted[i]);
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                stamp.add(c.faults[i].node + a, c.faults[i].node + b,
                          S(g[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)]));
            }
        }
    }
    // The order of summation is the order of the elements: the same network gives the same bits.
    return out;
}

template Assembly<double> assemble(Circuit const&, Topology const&, SwitchBits const&, Admittances<double> const&);
template Assembly<std::complex<double>> assemble(Circuit const&, Topology const&, SwitchBits const&,
                                                 Admittances<std::complex<double>> const&);

} // namespace gridspace::sim::emt
