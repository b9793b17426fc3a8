// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include "common/text.hpp"
#include "sim/opendss/dss_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::opendss {
namespace {

/// Entries of all matrices together: what a circuit may hold.
constexpr std::size_t kMaxAdmittances = 40'000'000;
constexpr int kMaxNodeNumber = 1000;

/// Series and shunt parts of an element of two terminals in one matrix.
Eigen::MatrixXcd two_terminals(Eigen::MatrixXcd const& series, Eigen::MatrixXcd const& shunt) {
    auto const n = series.rows();
    Eigen::MatrixXcd out(2 * n, 2 * n);
    out << series + shunt, -series, -series, series + shunt;
    return out;
}

/// The bus of the other end of what is connected to earth there: "671.1.2.3" gives "671.0.0.0".
std::string earthed(std::string const& bus, int conductors) {
    std::string out = bus.substr(0, bus.find('.'));
    for (int i = 0; i < conductors; ++i) {
        out += ".0";
    }
    return out;
}

/// A ring of equal branches over the conductors; one or two phases are an open ring over one conductor more.
Eigen::MatrixXcd ring(int phases, Complex y) {
    int const conductors = phases < 3 ? phases + 1 : phases;
    Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(conductors, conductors);
    for (int k = 0; k < phases; ++k) {
        int const next = (k + 1) % conductors;
        out(k, k) += y;
        out(next, next) += y;
        out(k, next) -= y;
        out(next, k) -= y;
    }
    return out;
}

} // namespace

Eigen::MatrixXcd star(int phases, Complex y) {
    return Eigen::MatrixXcd::Identity(phases, phases) * y;
}

Eigen::MatrixXcd from_sequences(int phases, Complex one, Complex zero) {
    Eigen::MatrixXcd out = Eigen::MatrixXcd::Constant(phases, phases, (zero - one) / 3.0);
    out.diagonal().setConstant((2.0 * one + zero) / 3.0);
    return out;
}

Builder::Builder(Script const& script, config::Diagnostics& diagnostics, std::optional<double> hour)
    : script_{script}, diagnostics_{diagnostics}, hour_{hour} {}

void Builder::error(config::SourceMark const& where, std::string message, std::string hint) {
    diagnostics_.error(where, std::move(message), std::move(hint));
}

std::optional<Circuit> Builder::build() {
    if (!diagnostics_.ok()) {
        return std::nullopt;
    }
    if (script_.circuit.empty()) {
        error({}, "the script makes no circuit", "expected `New Circuit.Name …`");
        return std::nullopt;
    }
    circuit_.name = script_.circuit;
    circuit_.left_out = script_.left_out;
    options();
    using Make = void (Builder::*)(Object const&);
    static std::map<std::string_view, Make> const kMake{
        {"vsource", &Builder::source},          {"line", &Builder::line},
        {"transformer", &Builder::transformer}, {"capacitor", &Builder::capacitor},
        {"reactor", &Builder::reactor},         {"load", &Builder::load},
        {"generator", &Builder::generator},     {"pvsystem", &Builder::photovoltaic}};
    // Controls point at elements, wherever in the script these stand.
    static std::map<std::string_view, Make> const kMakeControls{{"regcontrol", &Builder::regulator},
                                                                {"capcontrol", &Builder::capacitor_control}};
    for (auto const* table : {&kMake, &kMakeControls}) {
        for (Object const& object : script_.objects) {
            auto const it = table->find(object.info->name);
            if (it != table->end() && enabled(object) && !diagnostics_.full()) {
                (this->*it->second)(object);
            }
        }
    }
    if (!diagnostics_.ok()) {
        return std::nullopt;
    }
    check_connected();
    return std::move(circuit_);
}

void Builder::options() {
    auto const option = [&](char const* name) -> Word const* {
        auto const it = script_.options.find(name);
        return it == script_.options.end() ? nullptr : &it->second;
    };
    auto const value = [&](char const* name, double least, double otherwise) {
        Word const* word = option(name);
        if (word == nullptr) {
            return otherwise;
        }
        auto const x = evaluate(*word, diagnostics_);
        if (x && !(*x >= least)) {
            error(word->where, fmt::format("{} is {}", name, *x), fmt::format("expected at least {}", least));
        }
        return x.value_or(otherwise);
    };
    circuit_.frequency_hz = value("frequency", 1, value("basefrequency", 1, value("defaultbasefrequency", 1, 60)));
    omega_ = 2 * std::numbers::pi * circuit_.frequency_hz;
    load_multiplier_ = value("loadmult", 0, 1);
    circuit_.max_control_rounds =
        std::max(circuit_.max_control_rounds, static_cast<int>(std::min(value("maxcontroliter", 0, 0), 1e4)));
    if (Word const* mode = option("controlmode")) {
        circuit_.controls_act = !lower(mode->value).starts_with("off");
    }
    if (Word const* word = option("voltagebases")) {
        auto const rows = rows_of(*word, diagnostics_);
        for (std::size_t i = 0; rows && i < rows->size(); ++i) {
            for (double const kv : (*rows)[i]) {
                if (!(kv > 0)) {
                    error(word->where, fmt::format("a voltage base is {} kV", kv), "expected more than 0");
                }
                circuit_.voltage_bases_kv.push_back(kv);
            }
        }
    }
    for (auto const& [bus, word] : script_.bus_bases) {
        auto const kv = evaluate(word, diagnostics_);
        if (kv && !(*kv > 0)) {
            error(word.where, fmt::format("a voltage base is {} kV", *kv), "expected more than 0");
        }
        circuit_.bus_base_kv[bus] = kv.value_or(1) * (word.name == "kvln" ? kSqrt3 : 1);
    }
    static constexpr std::string_view kUnderstood[] = {"snapshot", "daily", "yearly", "dutycycle", "peakday"};
    if (Word const* mode = option("mode")) {
        std::string const word = lower(mode->value);
        bool const known = std::any_of(std::begin(kUnderstood), std::end(kUnderstood),
                                       [&](std::string_view k) { return k.starts_with(word); });
        if (!known) {
            circuit_.left_out.push_back(
                {mode->where, fmt::format("mode {}: one static solution is shown", word), true});
        } else if (!std::string_view{"snapshot"}.starts_with(word) && !hour_) {
            circuit_.left_out.push_back(
                {mode->where, fmt::format("mode {}: loads are as given, without their shapes", word), true});
        }
    }
}

std::vector<int> Builder::connect(Value const& bus, int phases, int conductors) {
    return connect(bus.text(), bus.where(), phases, conductors);
}

std::vector<int> Builder::connect(std::string const& bus, config::SourceMark const& where, int phases, int conductors) {
    std::vector<std::string> const parts = split(std::string{trim(bus)}, '.');
    std::string const key = lower(parts.front());
    if (key.empty()) {
        error(where, "a bus has no name");
        return std::vector<int>(static_cast<std::size_t>(conductors), -1);
    }
    auto const [it, fresh] = circuit_.bus_index.try_emplace(key, circuit_.buses.size());
    if (fresh) {
        circuit_.buses.push_back({parts.front(), {}});
    }
    Bus& here = circuit_.buses[it->second];
    std::vector<int> out;
    for (int i = 0; i < conductors; ++i) {
        int node = i < phases ? i + 1 : 0;
        auto const place = static_cast<std::size_t>(i) + 1;
        if (place < parts.size()) {
            auto const written = number(parts[place]);
            if (!written || *written < 0 || *written > kMaxNodeNumber || std::floor(*written) != *written) {
                error(where, fmt::format("'{}' of bus '{}' is not a node", parts[place], parts.front()),
                      fmt::format("expected a number from 0 to {}", kMaxNodeNumber));
            } else {
                node = static_cast<int>(*written);
            }
        }
        if (node == 0) {
            out.push_back(-1);
            continue;
        }
        auto const [n, new_node] = here.nodes.try_emplace(node, circuit_.nodes);
        circuit_.nodes += new_node ? 1 : 0;
        out.push_back(n->second);
    }
    return out;
}

void Builder::add_between(Object const& object, Terminals const& at, Eigen::MatrixXcd const& series,
                          Eigen::MatrixXcd const& shunt, Eigen::VectorXcd const& emf) {
    auto const phases = static_cast<int>(series.rows());
    std::vector<int> nodes = connect(at.bus1, at.where1, phases, phases);
    std::vector<int> const back =
        connect(at.bus2.empty() ? earthed(at.bus1, phases) : at.bus2, at.where2, phases, phases);
    nodes.insert(nodes.end(), back.begin(), back.end());
    Eigen::MatrixXcd y = two_terminals(series, shunt);
    Eigen::VectorXcd injected = emf.size() > 0 ? Eigen::VectorXcd{y * emf} : Eigen::VectorXcd{};
    add(object, std::move(nodes), phases, std::move(y), std::move(injected));
}

void Builder::add_branches(Object const& object, Terminals const& at, int phases, bool delta, Complex y) {
    if (!delta) {
        add_between(object, at, star(phases, y), Eigen::MatrixXcd::Zero(phases, phases));
        return;
    }
    Eigen::MatrixXcd branches = ring(phases, y);
    auto const conductors = static_cast<int>(branches.rows());
    add(object, connect(at.bus1, at.where1, phases, conductors), conductors, std::move(branches));
}

void Terminals::add_to(Meaning& meaning) {
    meaning["bus1"] = [this](Value const& v) { bus1 = v.text(), where1 = v.where(); };
    meaning["bus2"] = [this](Value const& v) { bus2 = v.text(), where2 = v.where(); };
}

void Builder::add(Object const& object, std::vector<int> nodes, int conductors, Eigen::MatrixXcd y,
                  Eigen::VectorXcd injected) {
    admittances_ += static_cast<std::size_t>(y.size());
    if (admittances_ > kMaxAdmittances) {
        error(object.where, fmt::format("the circuit has more than {} admittances", kMaxAdmittances));
        return;
    }
    if (!y.allFinite()) {
        error(object.where,
              fmt::format("{}.{} has an admittance that is no finite number", object.info->name, object.name),
              "are its impedances zero?");
        return;
    }
    // `open` of a conductor: its current is none, so its voltage in the element follows from the others.
    for (auto const& [terminal, conductor] : object.open) {
        int const first = conductor == 0 ? 1 : conductor, last = conductor == 0 ? conductors : conductor;
        for (int c = first; c <= last; ++c) {
            int const k = (terminal - 1) * conductors + c - 1;
            if (terminal < 1 || c > conductors || k >= y.rows()) {
                error(object.where, fmt::format("{}.{} has no terminal {}, conductor {} to open", object.info->name,
                                                object.name, terminal, c));
                return;
            }
            if (std::abs(y(k, k)) > 0) {
                y -= (y.col(k) * y.row(k) / y(k, k)).eval();
            }
            y.row(k).setZero();
            y.col(k).setZero();
        }
    }
    std::string name = fmt::format("{}.{}", object.info->name, object.name);
    circuit_.element_index.emplace(name, circuit_.elements.size());
    circuit_.elements.push_back(
        {std::move(name), conductors, std::move(nodes), std::move(y), std::move(injected), true});
}

void Builder::check_connected() {
    std::vector<int> leader(static_cast<std::size_t>(circuit_.nodes) + 1);
    for (std::size_t i = 0; i < leader.size(); ++i) {
        leader[i] = static_cast<int>(i);
    }
    auto const find = [&](int node) {
        auto at = static_cast<std::size_t>(node);
        while (leader[at] != static_cast<int>(at)) {
            leader[at] = leader[static_cast<std::size_t>(leader[at])];
            at = static_cast<std::size_t>(leader[at]);
        }
        return static_cast<int>(at);
    };
    int const source = circuit_.nodes; // stands for all sources
    for (Element const& e : circuit_.elements) {
        int first = e.injected.size() > 0 ? source : -1;
        for (std::size_t k = 0; k < e.nodes.size() && e.in_service; ++k) {
            auto const row = static_cast<Eigen::Index>(k);
            if (e.nodes[k] >= 0 && e.y.row(row).cwiseAbs().maxCoeff() > 0) {
                first = first < 0 ? e.nodes[k] : first;
                leader[static_cast<std::size_t>(find(e.nodes[k]))] = find(first);
            }
        }
    }
    int dead = 0;
    std::string name;
    for (Bus const& bus : circuit_.buses) {
        bool const fed = std::any_of(bus.nodes.begin(), bus.nodes.end(),
                                     [&](auto const& n) { return find(n.second) == find(source); });
        if (!fed && !bus.nodes.empty() && dead++ == 0) {
            name = bus.name;
        }
    }
    if (dead > 0) {
        diagnostics_.warning(script_.objects.front().where,
                             fmt::format("{} of {} buses are connected to no source and without voltage: bus '{}'{}",
                                         dead, circuit_.buses.size(), name, dead > 1 ? " and others" : ""));
    }
}

std::optional<std::size_t> Circuit::find_element(std::string_view full_name) const {
    auto const it = element_index.find(full_name);
    return it == element_index.end() ? std::nullopt : std::optional{it->second};
}

std::optional<std::size_t> Circuit::find_bus(std::string_view bus) const {
    auto const it = bus_index.find(bus);
    return it == bus_index.end() ? std::nullopt : std::optional{it->second};
}

std::optional<Circuit> build_circuit(Script const& script, config::Diagnostics& diagnostics,
                                     std::optional<double> hour) {
    return Builder{script, diagnostics, hour}.build();
}

} // namespace gridspace::opendss
