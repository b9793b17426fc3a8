// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/mode_elements.hpp"

#include <map>
#include <utility>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

/// Share of the energy from which an element is named, and how many are.
constexpr double kNamedShare = 0.1;
constexpr std::size_t kMaxNamed = 4;

/// Elements have no names in a circuit; the switch in front of them has that of their owner.
class Names {
  public:
    explicit Names(Circuit const& c) {
        for (Switch const& s : c.switches) {
            for (CurrentTerm const& term : s.terms) {
                names_.try_emplace({term.kind, term.index}, s.name.substr(0, s.name.find(" (")));
            }
        }
    }
    [[nodiscard]] std::string of(CurrentTerm::Kind kind, std::size_t index, std::string const& otherwise) const {
        auto const found = names_.find({kind, static_cast<int>(index)});
        return found == names_.end() ? otherwise : found->second;
    }

  private:
    std::map<std::pair<CurrentTerm::Kind, int>, std::string> names_;
};

} // namespace

std::vector<std::string> mode_elements(Circuit const& c, Topology const& t, std::vector<NortonImpedance> const& norton,
                                       Damped const& mode) {
    using Kind = CurrentTerm::Kind;
    Names const names{c};
    std::vector<std::pair<std::string, double>> energy;
    double total = 0;
    auto const holds = [&](std::string const& name, double joule) {
        total += joule;
        auto const seen = std::find_if(energy.begin(), energy.end(), [&](auto const& e) { return e.first == name; });
        if (seen == energy.end()) {
            energy.emplace_back(name, joule);
        } else {
            seen->second += joule;
        }
    };
    auto const at = [&](int node) {
        int const slot = t.slot[static_cast<std::size_t>(node)];
        return slot < t.unknowns ? mode.v[static_cast<std::size_t>(slot)] : Complex{};
    };
    // Of a capacitance C |dv|^2, of an inductance L |i|^2, both twice their mean.
    auto const triple = [&](int from, int to, auto const& entry) {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                sum += (std::conj(at(from + i) - at(to + i)) * entry(i, j) * (at(from + j) - at(to + j))).real();
            }
        }
        return sum;
    };
    double const s2 = std::norm(mode.s);
    auto const across = [&](auto const& element) {
        Complex sum{};
        for (std::size_t k = 0; k < 4; ++k) {
            sum += element.weights[k] * at(element.nodes[k]);
        }
        return std::norm(sum);
    };
    // L |1/(r + s l)|^2 |dv|^2, by sequence
    auto const magnetic = [&](PhaseMatrix const& r, PhaseMatrix const& l, int from, int to) {
        auto const weight = [&](double r_ohm, double l_h) {
            return l_h > 0 ? l_h / std::norm(r_ohm + mode.s * l_h) : 0;
        };
        auto const m = PhaseMatrix::sequence(weight(r.one, l.one), weight(r.zero(), l.zero()));
        return triple(from, to, [&](int i, int j) { return m.entry(i, j); });
    };
    for (std::size_t i = 0; i < c.rl.size(); ++i) {
        RlBranch const& b = c.rl[i];
        holds(names.of(Kind::rl, i, c.triples[static_cast<std::size_t>(b.from / 3)]), magnetic(b.r, b.l, b.from, b.to));
    }
    for (std::size_t i = 0; i < c.capacitors.size(); ++i) {
        CapacitorBranch const& b = c.capacitors[i];
        holds(names.of(Kind::capacitor, i, c.triples[static_cast<std::size_t>(b.from / 3)]),
              triple(b.from, b.to, [&](int row, int column) { return b.c.entry(row, column); }));
    }
    for (std::size_t i = 0; i < c.coupled.size(); ++i) {
        CoupledBranch const& b = c.coupled[i];
        bool const capacitive = b.kind == CoupledBranch::Kind::capacitive;
        if (!capacitive && no_inductance(b.l)) {
            continue;
        }
        Matrix3 const m = capacitive ? b.c : inverse(b.l);
        double const sum = triple(b.from, b.to, [&](int row, int column) {
            return m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
        });
        holds(names.of(Kind::coupled, i, c.triples[static_cast<std::size_t>(b.from / 3)]), capacitive ? sum : sum / s2);
    }
    for (std::size_t i = 0; i < c.norton.size(); ++i) {
        int const node = c.norton[i].node;
        holds(names.of(Kind::norton, i, c.triples[static_cast<std::size_t>(node / 3)]),
              magnetic(norton[i].r, norton[i].l, node, kEarth));
    }
    for (std::size_t i = 0; i < c.windings.size(); ++i) {
        Winding const& w = c.windings[i];
        holds(names.of(Kind::winding, i, c.triples[static_cast<std::size_t>(w.nodes[0] / 3)]),
              w.l > 0 ? across(w) * w.l / std::norm(w.r + mode.s * w.l) : 0);
    }
    for (std::size_t i = 0; i < c.cores.size(); ++i) {
        holds(names.of(Kind::core, i, c.triples[static_cast<std::size_t>(c.cores[i].nodes[0] / 3)]),
              across(c.cores[i]) / (s2 * c.cores[i].l));
    }
    std::stable_sort(energy.begin(), energy.end(), [](auto const& a, auto const& b) { return a.second > b.second; });
    std::vector<std::string> out;
    for (auto const& [name, joule] : energy) {
        if (out.size() < kMaxNamed && joule >= kNamedShare * total) {
            out.push_back(name);
        }
    }
    return out;
}

} // namespace gridspace::sim::emt
