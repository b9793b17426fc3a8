// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/matpower.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "sim/network/matlab_case.hpp"
#include "sim/network/network_check.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

namespace gridspace::sim {
namespace {

/// Rows of a case with named columns; a column that a short row lacks reads as `missing`.
class Table {
  public:
    Table(MatlabCase const& source, std::string const& name) {
        if (auto const it = source.matrices.find(name); it != source.matrices.end()) {
            matrix_ = &it->second;
        }
    }
    [[nodiscard]] std::size_t size() const {
        return matrix_ == nullptr || matrix_->rows.front().empty() ? 0 : matrix_->rows.size();
    }
    [[nodiscard]] double at(std::size_t row, std::size_t column, double missing = 0) const {
        auto const& r = matrix_->rows[row];
        return column <= r.size() ? r[column - 1] : missing;
    }
    [[nodiscard]] int line(std::size_t row) const {
        return row < matrix_->row_lines.size() ? matrix_->row_lines[row] : matrix_->line;
    }
    [[nodiscard]] std::size_t columns() const { return matrix_ == nullptr ? 0 : matrix_->rows.front().size(); }

  private:
    CaseMatrix const* matrix_{nullptr};
};

class Converter {
  public:
    Converter(MatlabCase const& source, std::shared_ptr<config::SourceText const> text,
              config::Diagnostics& diagnostics)
        : case_{source}, text_{std::move(text)}, diagnostics_{diagnostics} {}

    Network convert() {
        network_.where = {text_, 1, 1};
        network_.name = case_.name.empty() ? "matpower_case" : case_.name;
        auto const base = case_.scalars.find("baseMVA");
        if (base == case_.scalars.end()) {
            diagnostics_.error({text_, 1, 1}, "the case has no mpc.baseMVA", "is this a MATPOWER case file?");
            return network_;
        }
        base_mva_ = base->second;
        network_.power_kva = base_mva_ * 1e3;
        buses();
        generators();
        branches();
        Table const dc{case_, "dcline"};
        for (std::size_t r = 0; r < dc.size(); ++r) {
            if (dc.at(r, 3) != 0) {
                diagnostics_.error({text_, dc.line(r), 1}, "DC lines are not supported");
                break;
            }
        }
        return network_;
    }

  private:
    Ref ref(std::string name, int line) const { return {std::move(name), {text_, line, 1}}; }
    static std::string bus_name(double number) { return fmt::format("B{}", static_cast<std::int64_t>(number)); }
    double bus_v(double number) const {
        auto const it = voltages_.find(number);
        return it == voltages_.end() ? 1000 : it->second;
    }

    void buses() {
        Table const table{case_, "bus"};
        if (table.size() == 0 || table.columns() < 9) {
            diagnostics_.error({text_, 1, 1}, "the case has no complete matrix mpc.bus");
            return;
        }
        for (std::size_t r = 0; r < table.size(); ++r) {
            auto const type = type_of_bus(table, r);
            if (type == kIsolated) {
                isolated_.insert(table.at(r, 1)); // out of service, with everything at it
            } else if (type) {
                add_bus(table, r, *type);
            }
        }
    }

    static constexpr int kIsolated = 4;
    /// Nothing when the bus cannot be used, of which everything was said.
    std::optional<int> type_of_bus(Table const& table, std::size_t r) {
        int const line = table.line(r);
        double const number = table.at(r, 1);
        double const type = table.at(r, 2);
        if (number != std::floor(number) || number < 0 || number > 1e9) {
            diagnostics_.error({text_, line, 1}, fmt::format("a bus has the number {}", shortest(number)),
                               "expected a whole number");
            return std::nullopt;
        }
        if (type != 1 && type != 2 && type != 3 && type != kIsolated) {
            diagnostics_.error({text_, line, 1}, fmt::format("bus {} is of type {}", shortest(number), shortest(type)),
                               "expected 1 (PQ), 2 (PV), 3 (reference) or 4 (isolated)");
            return std::nullopt;
        }
        if (auto const [it, fresh] = seen_.try_emplace(number, line); !fresh) {
            diagnostics_.error({text_, line, 1}, fmt::format("bus {} is given twice", shortest(number)),
                               fmt::format("first on line {}", it->second));
            return std::nullopt;
        }
        return static_cast<int>(type);
    }

    void add_bus(Table const& table, std::size_t r, int type) {
        int const line = table.line(r);
        double const number = table.at(r, 1);
        Bus bus;
        bus.name = ref(bus_name(number), line);
        double const kv = table.at(r, 10);
        bus.voltage_v = kv > 0 ? kv * 1e3 : 1e3;
        if (table.at(r, 8) > 0) {
            bus.start = {table.at(r, 8), table.at(r, 9)};
        }
        types_[number] = type;
        if (type == 3) {
            slack_angle_[number] = table.at(r, 9);
        }
        double const p = table.at(r, 3), q = table.at(r, 4), g = table.at(r, 5), b = table.at(r, 6);
        if (p != 0 || q != 0) {
            Load load;
            load.name = ref(fmt::format("D{}", r + 1), line);
            load.bus = bus.name;
            load.p_kw = p * 1e3;
            load.q_kvar = q * 1e3;
            network_.loads.push_back(load);
        }
        if (g != 0 || b != 0) {
            Shunt shunt;
            shunt.name = ref(fmt::format("S{}", r + 1), line);
            shunt.bus = bus.name;
            shunt.p_kw = g * 1e3;
            shunt.q_kvar = b * 1e3;
            network_.shunts.push_back(shunt);
        }
        voltages_[number] = bus.voltage_v;
        network_.buses.push_back(bus);
    }

    void generators() {
        Table const table{case_, "gen"};
        std::map<double, bool> regulated; // buses whose voltage somebody holds already
        for (std::size_t r = 0; r < table.size(); ++r) {
            double const number = table.at(r, 1);
            if (table.at(r, 8, 1) <= 0 || isolated_.contains(number)) {
                continue;
            }
            Generator g;
            g.name = ref(fmt::format("G{}", r + 1), table.line(r));
            g.bus = ref(bus_name(number), table.line(r));
            // mBase is a base, not a limit: what the unit may give at most is its rating; 0 where nothing limits it.
            double const p_most = std::max(std::abs(table.at(r, 2)), table.at(r, 9));
            double const most = std::hypot(p_most, std::max(std::abs(table.at(r, 4)), std::abs(table.at(r, 5))));
            g.rating_kva = std::isfinite(most) && most < 1e9 ? std::max(most, table.at(r, 7)) * 1e3 : 0;
            g.p_kw = table.at(r, 2) * 1e3;
            g.q_kvar = table.at(r, 3) * 1e3;
            g.q_max_kvar = table.at(r, 4) * 1e3;
            g.q_min_kvar = table.at(r, 5) * 1e3;
            g.voltage_setpoint_pu = table.at(r, 6, 1);
            auto const type = types_.find(number);
            int const bus_type = type == types_.end() ? 1 : type->second;
            g.role = bus_type == 3 ? GeneratorRole::slack : bus_type == 2 ? GeneratorRole::pv : GeneratorRole::pq;
            g.angle_deg = bus_type == 3 ? slack_angle_[number] : 0;
            if (g.role != GeneratorRole::pq && regulated[number]) {
                // A further generator at the bus: its power counts, the bus's voltage and angle are held by the first.
                g.role = g.role == GeneratorRole::slack ? GeneratorRole::pq : GeneratorRole::pv;
            }
            regulated[number] = regulated[number] || g.role != GeneratorRole::pq;
            network_.generators.push_back(g);
        }
    }

    void branches() {
        Table const table{case_, "branch"};
        double const omega = 2 * std::numbers::pi * network_.frequency_hz;
        for (std::size_t r = 0; r < table.size(); ++r) {
            double const from = table.at(r, 1), to = table.at(r, 2);
            if (table.at(r, 11, 1) <= 0 || isolated_.contains(from) || isolated_.contains(to)) {
                continue;
            }
            double const ratio = table.at(r, 9), shift = table.at(r, 10);
            double const r_pu = table.at(r, 3), x_pu = table.at(r, 4), b_pu = table.at(r, 5);
            int const line = table.line(r);
            bool const known = types_.contains(from) && types_.contains(to);
            if (ratio != 0 || shift != 0 || (known && bus_v(from) != bus_v(to)) || x_pu < 0) {
                Transformer t;
                t.name = ref(fmt::format("T{}", r + 1), line);
                t.from = ref(bus_name(from), line);
                t.to = ref(bus_name(to), line);
                t.rating_kva = network_.power_kva;
                t.r_percent = r_pu * 100;
                t.x_percent = x_pu * 100;
                t.charging_percent = b_pu * 100;
                t.tap_ratio = ratio != 0 ? ratio : 1;
                t.phase_shift_deg = shift;
                network_.transformers.push_back(t);
                continue;
            }
            Line l;
            l.name = ref(fmt::format("L{}", r + 1), line);
            l.from = ref(bus_name(from), line);
            l.to = ref(bus_name(to), line);
            double const z_base = bus_v(from) * bus_v(from) / (network_.power_kva * 1e3);
            l.r_ohm = r_pu * z_base;
            l.x_ohm = x_pu * z_base;
            l.c_nf = b_pu / z_base / omega * 1e9;
            network_.lines.push_back(l);
        }
    }

    MatlabCase const& case_;
    std::shared_ptr<config::SourceText const> text_;
    config::Diagnostics& diagnostics_;
    Network network_;
    double base_mva_{100};
    std::map<double, int> seen_; ///< line of each bus
    std::map<double, int> types_;
    std::map<double, double> slack_angle_, voltages_;
    std::set<double> isolated_;
};

} // namespace

std::optional<Network> load_matpower(std::filesystem::path const& file, config::Diagnostics& diagnostics,
                                     config::SourceMark named_at) {
    int const before = diagnostics.errors();
    std::ifstream stream{file};
    if (!stream) {
        if (named_at.source == nullptr) {
            named_at.source = config::make_source(file.string(), "");
        }
        diagnostics.error(named_at, fmt::format("cannot read the file '{}'", file.string()), "no such file");
        return std::nullopt;
    }
    std::stringstream text;
    text << stream.rdbuf();
    auto const source = config::make_source(file.string(), text.str(), file.parent_path().string());
    MatlabCase const parsed = read_matlab_case(text.str(), source, diagnostics);
    if (diagnostics.errors() != before) {
        return std::nullopt;
    }
    Network network = Converter{parsed, source, diagnostics}.convert();
    if (diagnostics.errors() == before) {
        check_network(network, diagnostics);
    }
    return diagnostics.errors() == before ? std::optional{std::move(network)} : std::nullopt;
}

} // namespace gridspace::sim
