// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/shares.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>

namespace gridspace::sim::emt {
namespace {

class Sharing {
  public:
    Sharing(Topology const& t, Division const& d) : t_{t}, d_{d} {
        out.parts.resize(static_cast<std::size_t>(d.parts));
    }

    /// Of what elements add to earth nobody takes notice, but the next would wait for it: each adds elsewhere.
    [[nodiscard]] int slot(int node) {
        int const s = t_.slot[static_cast<std::size_t>(node)];
        return s == t_.earth() ? t_.slots + static_cast<int>(spare_++) % Topology::kEarths : s;
    }

    void branch(Share::Branches Share::* kind, int index, int from, int to, HistoryKind history, bool stores) {
        std::array<int, 6> const s{slot(from), slot(from + 1), slot(from + 2), slot(to), slot(to + 1), slot(to + 2)};
        Share::Branches& share = out.parts[home(s)].*kind;
        share.index.push_back(index);
        bool const to_earth = to == kEarth && s[0] < t_.unknowns;
        share.shunt.push_back(to_earth && s[1] == s[0] + 1 && s[2] == s[0] + 2 ? 1 : 0);
        share.from.insert(share.from.end(), s.begin(), s.begin() + 3);
        share.to.insert(share.to.end(), s.begin() + 3, s.end());
        for (std::size_t k = 0; stores && k < 3; ++k) {
            rest(s[k], history, 3 * index + static_cast<int>(k), -1);
            rest(s[3 + k], history, 3 * index + static_cast<int>(k), 1);
        }
    }

    void triple(Share::Terminals Share::* kind, int index, int node, HistoryKind history, double factor) {
        std::array<int, 3> const s{slot(node), slot(node + 1), slot(node + 2)};
        add(out.parts[home(s)].*kind, index, s);
        for (int k = 0; k < 3; ++k) {
            rest(s[static_cast<std::size_t>(k)], history, 3 * index + k, factor);
        }
    }

    void weighted(Share::Terminals Share::* kind, int index, std::array<int, 4> const& nodes,
                  std::array<double, 4> const& weights, HistoryKind history) {
        std::array<int, 4> const s{slot(nodes[0]), slot(nodes[1]), slot(nodes[2]), slot(nodes[3])};
        add(out.parts[home(s)].*kind, index, s);
        for (std::size_t k = 0; k < 4; ++k) {
            rest(s[k], history, index, -weights[k]);
        }
    }

    void coupling(Entry<double> const& e) {
        if (int const p = d_.of(e.row); p < d_.parts) {
            out.parts[static_cast<std::size_t>(p)].coupling.push_back(e);
        }
        rest(e.row, HistoryKind::voltage, e.column, -e.value);
    }

    void norton_corrections(int index, int node) {
        for (int k = 0; k < 3; ++k) {
            if (is_rest(slot(node + k))) {
                out.rest_norton.emplace_back(slot(node + k), 3 * index + k);
            }
        }
    }

    Shares out;

  private:
    /// The part that its nodes belong to; of one with none, in turn.
    [[nodiscard]] std::size_t home(std::span<int const> slots) {
        int found = -1;
        for (int const s : slots) {
            if (s < t_.unknowns && d_.of(s) < d_.parts) {
                assert(found < 0 || found == d_.of(s));
                found = d_.of(s);
            }
        }
        return static_cast<std::size_t>(found >= 0 ? found : static_cast<int>(next_++) % d_.parts);
    }

    static void add(Share::Terminals& share, int index, std::span<int const> slots) {
        share.index.push_back(index);
        share.slots.insert(share.slots.end(), slots.begin(), slots.end());
    }

    [[nodiscard]] bool is_rest(int s) const { return s < t_.unknowns && d_.of(s) == d_.parts; }

    void rest(int s, HistoryKind kind, int at, double factor) {
        if (is_rest(s)) {
            out.rest.push_back({s, kind, at, factor});
        }
    }

    Topology const& t_;
    Division const& d_;
    unsigned next_{0}, spare_{0};
};

int index_of(auto const& all, auto const& one) {
    return static_cast<int>(&one - all.data());
}

} // namespace

std::vector<std::pair<int, int>> element_ties(Circuit const& c, Topology const& t) {
    std::vector<std::pair<int, int>> out;
    int first = -1;
    auto const node = [&](int n) {
        int const s = t.slot[static_cast<std::size_t>(n)];
        if (s < t.unknowns) {
            out.emplace_back(first < 0 ? s : first, s);
            first = s;
        }
    };
    auto const triple = [&](int n) {
        for (int k = 0; k < 3; ++k) {
            node(n + k);
        }
    };
    auto const branches = [&](auto const& elements) {
        for (auto const& e : elements) {
            first = -1;
            triple(e.from);
            triple(e.to);
        }
    };
    auto const at_nodes = [&](auto const& elements) {
        for (auto const& e : elements) {
            first = -1;
            triple(e.node);
        }
    };
    auto const weighted = [&](auto const& elements) {
        for (auto const& e : elements) {
            first = -1;
            std::ranges::for_each(e.nodes, node);
        }
    };
    branches(c.rl);
    branches(c.capacitors);
    branches(c.coupled);
    weighted(c.windings);
    weighted(c.cores);
    auto const ends = [&](auto const& lines) { // only waves tie them
        for (auto const& line : lines) {
            first = -1;
            triple(line.from);
            first = -1;
            triple(line.to);
        }
    };
    ends(c.bergeron);
    ends(c.marti);
    at_nodes(c.injections);
    at_nodes(c.norton);
    return out;
}

Shares make_shares(Circuit const& c, Topology const& t, std::vector<Entry<double>> const& coupling,
                   Division const& division) {
    Sharing s{t, division};
    for (RlBranch const& b : c.rl) {
        s.branch(&Share::rl, index_of(c.rl, b), b.from, b.to, HistoryKind::rl, b.l.one != 0 || b.l.mutual != 0);
    }
    for (CapacitorBranch const& b : c.capacitors) {
        s.branch(&Share::capacitors, index_of(c.capacitors, b), b.from, b.to, HistoryKind::capacitor, true);
    }
    for (CoupledBranch const& b : c.coupled) {
        s.branch(&Share::coupled, index_of(c.coupled, b), b.from, b.to, HistoryKind::coupled, true);
    }
    for (Winding const& w : c.windings) {
        s.weighted(&Share::windings, index_of(c.windings, w), w.nodes, w.weights, HistoryKind::winding);
    }
    for (SaturableCore const& w : c.cores) {
        s.weighted(&Share::cores, index_of(c.cores, w), w.nodes, w.weights, HistoryKind::core);
    }
    auto const ends = [&](auto const& lines, Share::Terminals Share::* kind, HistoryKind history) {
        for (auto const& line : lines) {
            int const end = 2 * index_of(lines, line);
            s.triple(kind, end, line.from, history, -1);
            s.triple(kind, end + 1, line.to, history, -1);
        }
    };
    ends(c.bergeron, &Share::wave_ends, HistoryKind::wave);
    ends(c.marti, &Share::marti_ends, HistoryKind::marti);
    for (Injection const& i : c.injections) {
        s.triple(&Share::injections, index_of(c.injections, i), i.node, HistoryKind::injection, 1);
    }
    for (Entry<double> const& e : coupling) {
        s.coupling(e);
    }
    for (NortonPort const& p : c.norton) {
        s.triple(&Share::norton, index_of(c.norton, p), p.node, HistoryKind::norton, 1);
        s.norton_corrections(index_of(c.norton, p), p.node);
    }
    return std::move(s.out);
}

} // namespace gridspace::sim::emt
