// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network_check.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <set>

namespace gridspace::sim {
namespace {

using config::Diagnostics;

int width(Ref const& ref) {
    return static_cast<int>(ref.name.size());
}

/// Names by section, for lists that are as long as the network.
class Names {
  public:
    explicit Names(Network const& n) : n_{n} {
        for_each_kind(n, [&]<class T>(std::vector<T> const& elements) {
            std::set<std::string_view>& names = known_[T::kKind.section];
            for (Element const& e : elements) {
                names.insert(e.name.name);
            }
        });
    }
    /// `ref`, which `owner` uses, must name an element of that kind.
    bool must_exist(Kind const& kind, Ref const& ref, std::string const& owner, Diagnostics& diagnostics) const {
        if (known_.at(kind.section).contains(ref.name)) {
            return true;
        }
        std::vector<std::string> names;
        for_each_kind(n_, [&]<class T>(std::vector<T> const& elements) {
            for (std::size_t i = 0; T::kKind.section == kind.section && i < elements.size(); ++i) {
                names.push_back(elements[i].name.name);
            }
        });
        diagnostics.error(ref.where,
                          fmt::format("{} names the {} '{}', which does not exist", owner, kind.word, ref.name),
                          spelling_hint(ref.name, names, fmt::format("the network has no {}", kind.word)), width(ref));
        return false;
    }

  private:
    Network const& n_;
    std::map<std::string_view, std::set<std::string_view>> known_;
};

/// An element's own check, with its words around what it finds.
class Check final : public ElementCheck {
  public:
    Check(Element const& element, Names const& names, Surroundings const& around, Diagnostics& diagnostics)
        : element_{element}, owner_{owner_of(element)}, names_{names}, around_{around}, diagnostics_{diagnostics} {}
    [[nodiscard]] Surroundings const& around() const override { return around_; }
    bool exists(Kind const& kind, Ref const& ref) override {
        return names_.must_exist(kind, ref, owner_, diagnostics_);
    }
    void profile(Ref const& profile) override { (void)(profile.empty() || exists(Profile::kKind, profile)); }
    void wrong(std::string_view what, std::string hint) override { wrong_at(element_.name, what, std::move(hint)); }
    void wrong_at(Ref const& place, std::string_view what, std::string hint) override {
        diagnostics_.error(place.where, fmt::format("{} {}", owner_, what), std::move(hint), width(place));
    }
    /// One of the buses or the line by which an element says where it is. "Lacks the key 'bus'" was said before.
    void place(Kind const& kind, Ref const& ref) { (void)(ref.empty() || exists(kind, ref)); }

  private:
    Element const& element_;
    std::string owner_;
    Names const& names_;
    Surroundings const& around_;
    Diagnostics& diagnostics_;
};

void check_place(Element const& e, Check& check) {
    if (auto const* one_port = dynamic_cast<OnePort const*>(&e)) {
        check.place(Bus::kKind, one_port->bus);
    } else if (auto const* two_port = dynamic_cast<TwoPort const*>(&e)) {
        check.place(Bus::kKind, two_port->from);
        check.place(Bus::kKind, two_port->to);
        if (two_port->from == two_port->to && !two_port->to.empty()) {
            check.wrong_at(two_port->to, fmt::format("starts and ends at bus '{}'", two_port->to.name), "");
        }
    } else if (auto const* on_line = dynamic_cast<LineSwitch const*>(&e)) {
        check.place(Line::kKind, on_line->line);
    } else if (auto const* instrument = dynamic_cast<Instrument const*>(&e)) {
        check.place(Line::kKind, instrument->place().line);
        check.place(Bus::kKind, instrument->place().bus);
    }
}

void check_elements(Network const& n, Diagnostics& diagnostics) {
    Names const names{n};
    NetworkAround const around{n};
    for (Element const* e : all<Element>(n)) {
        Check check{*e, names, around, diagnostics};
        check_place(*e, check);
        e->check(check);
    }
}

/// A name stands for one thing: `disconnect: X` in an event must be unambiguous. Types and profiles are no such things,
/// and a bus and a device at it may share a name ("GRID").
void check_names(Network const& n, Diagnostics& diagnostics) {
    std::map<std::string_view, Element const*> seen;
    for (Element const* e : all<Element>(n)) {
        if (e->kind().prefix.empty() || e->kind().section == Bus::kKind.section) {
            continue;
        }
        auto const [it, fresh] = seen.try_emplace(e->name.name, e);
        if (!fresh) {
            diagnostics.error(
                e->name.where, fmt::format("the name '{}' is used twice", e->name.name),
                fmt::format("a {} has it at {}", it->second->kind().word, it->second->name.where.to_string()),
                width(e->name));
        }
    }
}

/// Between two ideal sources at one bus any current could flow.
void check_ideal_sources(Network const& n, Diagnostics& diagnostics) {
    std::map<std::string_view, OnePort const*> holders;
    for (OnePort const* e : one_ports(n)) {
        if (!holding_of(*e).ideal) {
            continue;
        }
        auto const [it, fresh] = holders.try_emplace(e->bus.name, e);
        if (!fresh) {
            diagnostics.error(e->name.where,
                              fmt::format("{} holds the voltage of bus '{}', which {} already does", owner_of(*e),
                                          e->bus.name, owner_of(*it->second)),
                              "nothing decides the current between two ideal sources: give one of them an impedance",
                              width(e->name));
        }
    }
}

/// Two devices with one face at one end of one line. `place` says where one is.
template <class Face, class Place>
void check_line_ends(Network const& n, Place const& place, Diagnostics& diagnostics) {
    std::map<std::pair<std::string, LineEnd>, Face const*> seen;
    for (Face const* d : all<Face>(n)) {
        auto const [line, end] = place(*d);
        if (line.empty()) {
            continue;
        }
        auto const [it, fresh] = seen.try_emplace({line, end}, d);
        if (!fresh) {
            diagnostics.error(
                d->name.where, fmt::format("{} stands where {} already is", owner_of(*d), owner_of(*it->second)),
                fmt::format("line {}, end {}", line, end == LineEnd::from ? "from" : "to"), width(d->name));
        }
    }
}

/// Which buses something that holds voltage reaches, over all two-ports but those that are `open`.
std::vector<bool> fed_buses(Network const& n, std::set<std::string_view> const& open) {
    NameIndex const buses{n.buses};
    std::vector<std::size_t> root(n.buses.size());
    std::iota(root.begin(), root.end(), std::size_t{0});
    auto const top = [&](std::size_t i) {
        while (root[i] != i) {
            i = root[i] = root[root[i]];
        }
        return i;
    };
    for (TwoPort const* e : two_ports(n)) {
        if (!open.contains(e->name.name)) {
            root[top(buses[e->from.name])] = top(buses[e->to.name]);
        }
    }
    std::vector<bool> fed_roots(n.buses.size(), false), fed(n.buses.size());
    for (OnePort const* e : one_ports(n)) {
        if (holding_of(*e).keeps_alive) {
            fed_roots[top(buses[e->bus.name])] = true;
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
    std::set<std::string_view> open;
    for (LineSwitch const* s : all<LineSwitch>(n)) {
        if (!s->closed_at_start()) {
            open.insert(s->line.name);
        }
    }
    auto const ever = fed_buses(n, {}), at_start = fed_buses(n, open);
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
    check_ideal_sources(n, diagnostics);
    check_elements(n, diagnostics);
    check_line_ends<LineSwitch>(n, [](LineSwitch const& s) { return std::pair{s.line.name, s.end}; }, diagnostics);
    check_line_ends<Instrument>(
        n,
        [](Instrument const& i) {
            auto const place = i.place();
            return std::pair{place.line.name, place.end};
        },
        diagnostics);
    if (diagnostics.errors() == before) {
        check_islands(n, diagnostics);
    }
}

} // namespace gridspace::sim
