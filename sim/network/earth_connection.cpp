// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/earth_connection.hpp"

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

/// With the switches as they are at the start.
Ends closed_ends(Network const& n, TwoPort const& e) {
    Ends closed;
    for (LineSwitch const* s : all<LineSwitch>(n)) {
        if (s->line == e.name && !s->closed_at_start()) {
            (s->end == LineEnd::from ? closed.from : closed.to) = false;
        }
    }
    return closed;
}

} // namespace

std::optional<std::size_t> unearthed_bus(Network const& n) {
    Connections c{n};
    NetworkAround const around{n};
    for (TwoPort const* e : two_ports(n)) {
        EarthPaths const paths = e->earth_paths(around, closed_ends(n, *e));
        if (paths.joins) {
            c.join(e->from, e->to);
        }
        if (paths.from) {
            c.earth(e->from);
        }
        if (paths.to) {
            c.earth(e->to);
        }
    }
    for (OnePort const* e : one_ports(n)) {
        if (e->earthed(around) && e->closed_at_start()) {
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
