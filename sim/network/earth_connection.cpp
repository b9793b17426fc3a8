// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/earth_connection.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace gridspace::sim {
namespace {

/// Which buses the zero sequence joins, and to earth (the last place).
class Connections {
  public:
    explicit Connections(Network const& n) : n_{n}, root_(n.buses.size() + 1) {
        std::iota(root_.begin(), root_.end(), std::size_t{0});
    }

    void join(Ref const& a, Ref const& b) { root_[top(place(a))] = top(place(b)); }
    void earth(Ref const& bus) { root_[top(place(bus))] = top(n_.buses.size()); }
    template <class Elements>
    void earth_all(Elements const& elements) {
        for (auto const& e : elements) {
            earth(e.bus);
        }
    }
    [[nodiscard]] bool earthed(std::size_t bus) { return top(bus) == top(n_.buses.size()); }

  private:
    [[nodiscard]] std::size_t place(Ref const& bus) const { return index_of(n_.buses, bus.name); }
    std::size_t top(std::size_t i) {
        while (root_[i] != i) {
            i = root_[i] = root_[root_[i]];
        }
        return i;
    }
    Network const& n_;
    std::vector<std::size_t> root_;
};

void lines(Network const& n, Connections& c) {
    for (Line const& line : n.lines) {
        auto const closed = [&](LineEnd end) {
            return std::none_of(n.breakers.begin(), n.breakers.end(),
                                [&](Breaker const& b) { return b.line == line.name && b.end == end && !b.closed; });
        };
        LineTotals const t = line_totals(n, line);
        bool const charged = t.c_f > 0 || t.c0_f > 0;
        bool const from = closed(LineEnd::from), to = closed(LineEnd::to);
        if (from && to) {
            c.join(line.from, line.to);
        }
        if (charged && from) {
            c.earth(line.from);
        }
        if (charged && to) {
            c.earth(line.to);
        }
    }
}

void transformers(Network const& n, Connections& c) {
    for (Transformer const& t : n.transformers) {
        bool const from = t.from_winding == Winding::wye_grounded, to = t.to_winding == Winding::wye_grounded;
        if (t.charging_percent != 0) {
            c.earth(t.from);
            c.earth(t.to);
        }
        if (from && (t.to_winding == Winding::delta || t.magnetising_percent > 0)) {
            c.earth(t.from);
        }
        if (to && t.from_winding == Winding::delta) {
            c.earth(t.to);
        }
        if (from && to) {
            c.join(t.from, t.to);
        }
    }
}

} // namespace

std::optional<std::size_t> unearthed_bus(Network const& n) {
    Connections c{n};
    lines(n, c);
    transformers(n, c);
    c.earth_all(n.sources);
    c.earth_all(n.generators); // slack ones are sources, the others have filters
    for (Machine const& m : n.machines) {
        MachineType const* type = find(n.machine_types, m.type.name);
        if (type != nullptr && type->pu.x0 > 0) {
            c.earth(m.bus);
        }
    }
    for (OnePort const* e : one_ports(n)) {
        if (e->earthed() && e->closed_at_start()) {
            c.earth(e->bus);
        }
    }
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        if (!c.earthed(i)) {
            return i;
        }
    }
    return std::nullopt;
}

} // namespace gridspace::sim
