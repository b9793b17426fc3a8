// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network_check.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>
#include <numeric>

namespace gridspace::sim {
namespace {

using config::Diagnostics;

int width(Ref const& ref) {
    return static_cast<int>(ref.name.size());
}

/// Elements by name, for lists that are as long as the network.
template <class T>
class ByName {
  public:
    explicit ByName(std::vector<T> const& elements) : elements_{elements}, index_{elements} {}
    [[nodiscard]] T const* find(std::string_view name) const {
        std::size_t const i = index_[name];
        return i < elements_.size() ? &elements_[i] : nullptr;
    }
    [[nodiscard]] std::vector<T> const& elements() const { return elements_; }

  private:
    std::vector<T> const& elements_;
    NameIndex index_;
};

/// `ref`, which `owner` uses, must name one of `known`.
template <class T>
bool must_exist(ByName<T> const& known, Ref const& ref, std::string_view kind, std::string const& owner,
                Diagnostics& diagnostics) {
    if (known.find(ref.name) != nullptr) {
        return true;
    }
    std::vector<std::string> names;
    for (T const& element : known.elements()) {
        names.push_back(element.name.name);
    }
    std::string const hint = spelling_hint(ref.name, names, fmt::format("the network has no {}", kind));
    diagnostics.error(ref.where, fmt::format("{} names the {} '{}', which does not exist", owner, kind, ref.name), hint,
                      width(ref));
    return false;
}

template <class T>
bool at_bus(ByName<Bus> const& buses, std::vector<T> const& elements, std::string_view kind, Diagnostics& diagnostics) {
    bool ok = true;
    for (T const& e : elements) {
        if (e.bus.empty()) {
            ok = false; // "lacks the key 'bus'" was said when it was read
            continue;
        }
        ok = must_exist(buses, e.bus, "bus", fmt::format("{} '{}'", kind, e.name.name), diagnostics) && ok;
    }
    return ok;
}

void check_names(Network const& n, Diagnostics& diagnostics) {
    // A name stands for one thing: `disconnect: X` in an event must be unambiguous.
    std::map<std::string, std::pair<std::string_view, Ref>> seen;
    auto const add = [&](auto const& elements, std::string_view kind) {
        for (auto const& e : elements) {
            auto const [it, fresh] = seen.try_emplace(e.name.name, kind, e.name);
            if (!fresh) {
                diagnostics.error(
                    e.name.where, fmt::format("the name '{}' is used twice", e.name.name),
                    fmt::format("a {} has it at {}", it->second.first, it->second.second.where.to_string()),
                    width(e.name));
            }
        }
    };
    // A bus and the source, machine or profile at it may share a name ("GRID"); devices among themselves may not.
    add(n.lines, "line");
    add(n.transformers, "transformer");
    add(n.breakers, "breaker");
    add(n.cts, "CT");
    add(n.vts, "VT");
    add(n.machines, "machine");
    add(n.generators, "generator");
    for_each_kind(n, [&]<class T>(std::vector<T> const& elements) { add(elements, T::kKind.word); });
    add(n.sources, "source");
}

/// Below this share of the base impedance the current of a branch is a difference of voltages that agree in nearly all
/// of their digits: rounding errors would be amperes.
constexpr double kMinImpedancePu = 1e-10;

/// Impedances in ohm, `positive` and `zero` sequence, of something at a bus.
void check_least_impedance(Network const& n, std::string const& owner, Ref const& name, Bus const* bus,
                           double positive_ohm, double zero_ohm, Diagnostics& diagnostics) {
    if (bus == nullptr) {
        return;
    }
    double const least = kMinImpedancePu * bus->voltage_v * bus->voltage_v / (n.power_kva * 1e3);
    double const smaller = std::min(positive_ohm, zero_ohm);
    if (smaller > 0 && smaller < least) {
        diagnostics.error(
            name.where,
            fmt::format("{} has {} ohm{}, too little to compute its current: at least {:.2g} ohm are needed here",
                        owner, shortest(smaller), smaller < positive_ohm ? " in the zero sequence" : "", least),
            "make its two ends one bus, or give it more", width(name));
    }
}

void check_branches(Network const& n, Diagnostics& diagnostics) {
    double const omega = 2 * std::numbers::pi * n.frequency_hz;
    ByName const buses{n.buses};
    ByName const line_types{n.line_types};
    for (Line const& line : n.lines) {
        std::string const owner = fmt::format("line '{}'", line.name.name);
        must_exist(buses, line.from, "bus", owner, diagnostics);
        must_exist(buses, line.to, "bus", owner, diagnostics);
        if (!line.type.empty() && !must_exist(line_types, line.type, "line type", owner, diagnostics)) {
            continue;
        }
        Bus const* from = buses.find(line.from.name);
        Bus const* to = buses.find(line.to.name);
        if (line.from == line.to) {
            diagnostics.error(line.to.where, fmt::format("{} starts and ends at bus '{}'", owner, line.to.name), "",
                              width(line.to));
        } else if (from != nullptr && to != nullptr && from->voltage_v != to->voltage_v) {
            diagnostics.error(line.name.where,
                              fmt::format("{} joins buses of {} V and {} V", owner, shortest(from->voltage_v),
                                          shortest(to->voltage_v)),
                              "buses of different voltage need a transformer", width(line.name));
        }
        LineTotals const t = line_totals(n, line);
        if (t.r_ohm == 0 && t.l_h == 0) {
            diagnostics.error(line.name.where, fmt::format("{} has no impedance", owner),
                              "make it one bus, or give it a small resistance", width(line.name));
        } else if (t.r0_ohm == 0 && t.l0_h == 0) {
            diagnostics.error(line.name.where, fmt::format("{} has no zero sequence impedance", owner),
                              "leave out r0_ohm and l0_mh (x0_ohm) to take those of the positive sequence",
                              width(line.name));
        } else {
            check_least_impedance(n, owner, line.name, from, std::hypot(t.r_ohm, omega * t.l_h),
                                  std::hypot(t.r0_ohm, omega * t.l0_h), diagnostics);
        }
    }
    for (Source const& s : n.sources) {
        bool const impedance = s.r_ohm != 0 || s.l_mh != 0;
        bool const zero = s.r0_ohm.value_or(s.r_ohm) != 0 || s.l0_mh.value_or(s.l_mh) != 0;
        if (impedance != zero) {
            diagnostics.error(s.name.where,
                              fmt::format("source '{}' has a {} sequence impedance but no {} sequence impedance",
                                          s.name.name, impedance ? "positive" : "zero",
                                          impedance ? "zero" : "positive"),
                              "give both, or neither", width(s.name));
        }
        check_least_impedance(n, fmt::format("source '{}'", s.name.name), s.name, buses.find(s.bus.name),
                              std::hypot(s.r_ohm, omega * s.l_mh * 1e-3),
                              std::hypot(s.r0_ohm.value_or(s.r_ohm), omega * s.l0_mh.value_or(s.l_mh) * 1e-3),
                              diagnostics);
    }
    for (Transformer const& t : n.transformers) {
        std::string const owner = fmt::format("transformer '{}'", t.name.name);
        must_exist(buses, t.from, "bus", owner, diagnostics);
        must_exist(buses, t.to, "bus", owner, diagnostics);
        if (t.from == t.to) {
            diagnostics.error(t.to.where, fmt::format("{} starts and ends at bus '{}'", owner, t.to.name), "",
                              width(t.to));
        }
        if (t.r_percent == 0 && t.x_percent == 0) {
            diagnostics.error(t.name.where, fmt::format("{} has no short-circuit impedance", owner),
                              "give x_percent; an ideal transformer has no current that could be computed",
                              width(t.name));
        } else if (std::hypot(t.r_percent, t.x_percent) / 100 * n.power_kva < kMinImpedancePu * t.rating_kva) {
            diagnostics.error(
                t.name.where,
                fmt::format("{} has {} %, too little to compute its current", owner,
                            shortest(std::hypot(t.r_percent, t.x_percent))),
                fmt::format("give it at least {:.2g} %", 100 * kMinImpedancePu * t.rating_kva / n.power_kva),
                width(t.name));
        }
    }
}

/// An element's own check, with its words around what it finds.
class Check final : public ElementCheck {
  public:
    Check(OnePort const& element, ByName<Profile> const& profiles, Diagnostics& diagnostics)
        : element_{element}, owner_{fmt::format("{} '{}'", element.kind().word, element.name.name)},
          profiles_{profiles}, diagnostics_{diagnostics} {}
    void profile(Ref const& profile) override {
        if (!profile.empty()) {
            must_exist(profiles_, profile, "profile", owner_, diagnostics_);
        }
    }
    void wrong(std::string_view what, std::string hint) override {
        diagnostics_.error(element_.name.where, fmt::format("{} {}", owner_, what), std::move(hint),
                           width(element_.name));
    }

  private:
    OnePort const& element_;
    std::string owner_;
    ByName<Profile> const& profiles_;
    Diagnostics& diagnostics_;
};

void check_one_ports(Network const& n, Diagnostics& diagnostics) {
    ByName const profiles{n.profiles};
    for (OnePort const* e : one_ports(n)) {
        Check check{*e, profiles, diagnostics};
        e->check(check);
    }
}

/// Between two ideal sources at one bus any current could flow.
void check_ideal_sources(Network const& n, Diagnostics& diagnostics) {
    std::map<std::string, std::string> holders;
    auto const hold = [&](Ref const& name, Ref const& bus, std::string const& owner) {
        auto const [it, fresh] = holders.try_emplace(bus.name, owner);
        if (!fresh) {
            diagnostics.error(
                name.where,
                fmt::format("{} holds the voltage of bus '{}', which {} already does", owner, bus.name, it->second),
                "nothing decides the current between two ideal sources: give one of them an impedance", width(name));
        }
    };
    for (Source const& s : n.sources) {
        if (s.r_ohm == 0 && s.l_mh == 0) {
            hold(s.name, s.bus, fmt::format("source '{}'", s.name.name));
        }
    }
    for (Generator const& g : n.generators) {
        if (g.role == GeneratorRole::slack) {
            hold(g.name, g.bus, fmt::format("generator '{}'", g.name.name));
        }
    }
}

/// Two devices of one kind at one end of one line.
template <class T>
void check_line_ends(Network const& n, std::vector<T> const& devices, std::string_view kind, Diagnostics& diagnostics) {
    std::map<std::pair<std::string, LineEnd>, std::string> seen;
    ByName const lines{n.lines};
    for (T const& d : devices) {
        std::string const owner = fmt::format("{} '{}'", kind, d.name.name);
        if (!must_exist(lines, d.line, "line", owner, diagnostics)) {
            continue;
        }
        auto const [it, fresh] = seen.try_emplace({d.line.name, d.end}, d.name.name);
        if (!fresh) {
            diagnostics.error(d.name.where, fmt::format("{} stands where {} '{}' already is", owner, kind, it->second),
                              fmt::format("line {}, end {}", d.line.name, d.end == LineEnd::from ? "from" : "to"),
                              width(d.name));
        }
    }
}

/// Which buses something that holds voltage reaches, over transformers and over the lines that `joins`.
template <class Joins>
std::vector<bool> fed_buses(Network const& n, Joins joins) {
    NameIndex const buses{n.buses};
    std::vector<std::size_t> root(n.buses.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    auto const top = [&](std::size_t i) {
        while (root[i] != i) {
            i = root[i] = root[root[i]];
        }
        return i;
    };
    auto const join_buses = [&](Ref const& a, Ref const& b) { root[top(buses[a.name])] = top(buses[b.name]); };
    for (Line const& line : n.lines) {
        if (joins(line)) {
            join_buses(line.from, line.to);
        }
    }
    for (Transformer const& t : n.transformers) {
        join_buses(t.from, t.to);
    }
    std::vector<bool> fed_roots(n.buses.size(), false), fed(n.buses.size());
    auto const feed = [&](Ref const& bus) { fed_roots[top(buses[bus.name])] = true; };
    for (Source const& s : n.sources) {
        feed(s.bus);
    }
    for (Machine const& m : n.machines) {
        feed(m.bus);
    }
    for (Generator const& g : n.generators) {
        if (g.role == GeneratorRole::slack) {
            feed(g.bus);
        }
    }
    for (std::size_t i = 0; i < fed.size(); ++i) {
        fed[i] = fed_roots[top(i)];
    }
    return fed;
}

/// Every bus must be reached from something that holds voltage. Behind a breaker that is open at the start it has none
/// until that closes.
void check_islands(Network const& n, Diagnostics& diagnostics) {
    auto const closed = [&](Line const& line) {
        return std::none_of(n.breakers.begin(), n.breakers.end(),
                            [&](Breaker const& b) { return b.line == line.name && !b.closed; });
    };
    auto const ever = fed_buses(n, [](Line const&) { return true; }), at_start = fed_buses(n, closed);
    if (std::find(ever.begin(), ever.end(), true) == ever.end()) {
        diagnostics.error(n.where, "nothing holds the voltage of this network",
                          "it needs a source, a machine, or a generator with `role: slack`");
        return;
    }
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        Bus const& bus = n.buses[i];
        if (!ever[i]) {
            diagnostics.error(bus.name.where,
                              fmt::format("bus '{}' is islanded: no line or transformer joins it to a source, machine "
                                          "or slack generator",
                                          bus.name.name),
                              "join it, or remove it", width(bus.name));
        } else if (!at_start[i]) {
            diagnostics.warning(
                bus.name.where,
                fmt::format("bus '{}' has no voltage at the start: it is behind a breaker that is open", bus.name.name),
                "with `state: closed` at that breaker it has", width(bus.name));
        }
    }
}

} // namespace

void check_network(Network const& n, Diagnostics& diagnostics) {
    int const before = diagnostics.errors();
    if (n.buses.empty()) {
        diagnostics.error(n.where, "the network has no buses", "a section `buses:` is needed");
        return;
    }
    check_names(n, diagnostics);
    check_branches(n, diagnostics);
    check_ideal_sources(n, diagnostics);
    check_one_ports(n, diagnostics);
    check_line_ends(n, n.breakers, "breaker", diagnostics);
    check_line_ends(n, n.cts, "CT", diagnostics);
    ByName const buses{n.buses};
    at_bus(buses, n.sources, "source", diagnostics);
    at_bus(buses, n.vts, "VT", diagnostics);
    at_bus(buses, n.machines, "machine", diagnostics);
    at_bus(buses, n.generators, "generator", diagnostics);
    for_each_kind(
        n, [&]<class T>(std::vector<T> const& elements) { at_bus(buses, elements, T::kKind.word, diagnostics); });
    for (Breaker const& b : n.breakers) {
        must_exist(ByName{n.breaker_types}, b.type, "breaker type", fmt::format("breaker '{}'", b.name.name),
                   diagnostics);
    }
    for (Ct const& c : n.cts) {
        must_exist(ByName{n.ct_types}, c.type, "CT type", fmt::format("CT '{}'", c.name.name), diagnostics);
    }
    for (Vt const& v : n.vts) {
        must_exist(ByName{n.vt_types}, v.type, "VT type", fmt::format("VT '{}'", v.name.name), diagnostics);
    }
    for (Machine const& m : n.machines) {
        must_exist(ByName{n.machine_types}, m.type, "machine type", fmt::format("machine '{}'", m.name.name),
                   diagnostics);
    }
    if (diagnostics.errors() == before) {
        check_islands(n, diagnostics);
    }
}

} // namespace gridspace::sim
