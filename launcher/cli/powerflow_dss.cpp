// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/powerflow_dss.hpp"

#include "common/text.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/folder/write_file.hpp"
#include "sim/opendss/opendss_file.hpp"
#include "sim/opendss/solve.hpp"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;
using opendss::Circuit;
using opendss::CircuitFlow;
using opendss::Complex;

/// A node of a bus, with its voltage.
struct NodeRow {
    std::string bus;
    int node;
    double volts, degrees;
    std::optional<double> pu;
};

std::vector<NodeRow> node_rows(Circuit const& circuit, CircuitFlow const& flow) {
    std::vector<NodeRow> rows;
    for (std::size_t b = 0; b < circuit.buses.size(); ++b) {
        double const base_v = flow.bus_base_kv[b] * 1e3 / std::sqrt(3.0);
        for (auto const& [number, node] : circuit.buses[b].nodes) {
            Complex const v = flow.v[node];
            std::optional<double> pu;
            if (base_v > 0) {
                pu = std::abs(v) / base_v;
            }
            rows.push_back({circuit.buses[b].name, number, std::abs(v), std::arg(v) * 180 / std::numbers::pi, pu});
        }
    }
    return rows;
}

Json power_json(Complex va) {
    return {{"p_kw", va.real() / 1e3}, {"q_kvar", va.imag() / 1e3}};
}

/// "storage.battery (feeder.dss:12:5)" of what is not part of the solution, those of one kind together.
std::vector<std::string> left_out_lines(std::vector<opendss::LeftOut> const& all, bool changing) {
    std::map<std::string, std::pair<std::string, int>> first_of; // by class, or by the whole text
    for (opendss::LeftOut const& item : all) {
        if (item.changes_result == changing) {
            std::string const kind = item.what.substr(0, item.what.find_first_of(". "));
            std::string const where = item.where.source == nullptr ? "" : " (" + item.where.to_string() + ")";
            auto const [it, fresh] = first_of.try_emplace(kind, item.what + where, 0);
            ++it->second.second;
        }
    }
    std::vector<std::string> out;
    for (auto const& [kind, row] : first_of) {
        out.push_back(row.second > 1 ? fmt::format("{} and {} more", row.first, row.second - 1) : row.first);
    }
    return out;
}

void print_json(Circuit const& circuit, CircuitFlow const& flow) {
    Json buses = Json::array(), regulators = Json::array(), capacitors = Json::array(), left_out = Json::array();
    for (NodeRow const& row : node_rows(circuit, flow)) {
        if (buses.empty() || buses.back()["name"] != row.bus) {
            buses.push_back({{"name", row.bus}, {"nodes", Json::array()}});
        }
        Json node{{"node", row.node}, {"v_v", row.volts}, {"angle_deg", row.degrees}};
        node["v_pu"] = row.pu ? Json(*row.pu) : Json(nullptr);
        buses.back()["nodes"].push_back(node);
    }
    for (std::size_t i = 0; i < circuit.regulators.size(); ++i) {
        auto const& r = circuit.regulators[i];
        regulators.push_back({{"name", r.name},
                              {"tap_position", tap_position(r, circuit)},
                              {"tap_pu", circuit.transformers.at(r.element).windings[r.tap_winding].tap},
                              {"relay_v", flow.regulators[i].measured_v},
                              {"setpoint_v", r.setpoint_v},
                              {"band_v", r.band_v}});
    }
    for (auto const& c : circuit.capacitor_controls) {
        auto const& bank = circuit.elements[c.capacitor];
        capacitors.push_back({{"name", bank.name}, {"control", c.name}, {"closed", bank.in_service}});
    }
    for (auto const& item : circuit.left_out) {
        left_out.push_back({{"what", item.what},
                            {"where", item.where.source == nullptr ? "" : item.where.to_string()},
                            {"changes_result", item.changes_result}});
    }
    fmt::print("{}\n", Json{{"converged", true},
                            {"circuit", circuit.name},
                            {"iterations", flow.iterations},
                            {"control_rounds", flow.control_rounds},
                            {"controls_settled", flow.controls_settled},
                            {"buses", buses},
                            {"regulators", regulators},
                            {"capacitor_controls", capacitors},
                            {"source", power_json(flow.source_va)},
                            {"generators", power_json(flow.generated_va)},
                            {"loads", power_json(flow.consumed_va)},
                            {"losses", power_json(flow.losses_va)},
                            {"not_taken_over", left_out}}
                           .dump(2));
}

void print_tables(Circuit const& circuit, CircuitFlow const& flow) {
    fmt::print("{}: converged in {} iterations, {} round{} of controls\n\n", printable(circuit.name), flow.iterations,
               flow.control_rounds, flow.control_rounds == 1 ? "" : "s");
    fmt::print("{:<20} {:>4} {:>10} {:>12} {:>10}\n", "bus", "node", "v, p.u.", "v, V", "angle, deg");
    std::string last;
    for (NodeRow const& row : node_rows(circuit, flow)) {
        fmt::print("{:<20} {:>4} {:>10} {:>12.3f} {:>10.3f}\n", row.bus == last ? "" : printable(row.bus), row.node,
                   row.pu ? fmt::format("{:.5f}", *row.pu) : "-", row.volts, row.degrees);
        last = row.bus;
    }
    if (circuit.voltage_bases_kv.empty() && circuit.bus_base_kv.empty()) {
        fmt::print("p.u. need bases: `Set VoltageBases=[…]` in the script\n");
    }
    if (!circuit.regulators.empty()) {
        fmt::print("\n{:<24} {:>5} {:>9} {:>10} {:>14}\n", "regulator", "tap", "p.u.", "relay, V", "its band, V");
    }
    for (std::size_t i = 0; i < circuit.regulators.size(); ++i) {
        auto const& r = circuit.regulators[i];
        fmt::print("{:<24} {:>5} {:>9.5f} {:>10.2f} {:>14}\n", printable(r.name), tap_position(r, circuit),
                   circuit.transformers.at(r.element).windings[r.tap_winding].tap, flow.regulators[i].measured_v,
                   fmt::format("{:.1f} to {:.1f}", r.setpoint_v - r.band_v / 2, r.setpoint_v + r.band_v / 2));
    }
    for (auto const& c : circuit.capacitor_controls) {
        auto const& bank = circuit.elements[c.capacitor];
        fmt::print("{:<24} {}\n", printable(bank.name), bank.in_service ? "closed" : "open");
    }
    fmt::print("\n{:<12} {:>14} {:>14}\n", "", "kW", "kvar");
    auto const row = [](char const* what, Complex va) {
        fmt::print("{:<12} {:>14.3f} {:>14.3f}\n", what, va.real() / 1e3, va.imag() / 1e3);
    };
    row("sources", flow.source_va);
    row("generators", flow.generated_va);
    row("loads", flow.consumed_va);
    row("losses", flow.losses_va);
    for (bool const changing : {true, false}) {
        auto const lines = left_out_lines(circuit.left_out, changing);
        if (!lines.empty()) {
            fmt::print("\n{}\n", changing ? "not taken over, OpenDSS's solution may differ:" : "without effect here:");
        }
        for (std::string const& line : lines) {
            fmt::print("  {}\n", printable(line));
        }
    }
}

std::string csv_of(Circuit const& circuit, CircuitFlow const& flow) {
    std::string out = "bus,node,v_pu,v_v,angle_deg\n";
    for (NodeRow const& row : node_rows(circuit, flow)) {
        out += fmt::format("{},{},{},{},{}\n", row.bus, row.node, row.pu ? shortest(*row.pu) : "", shortest(row.volts),
                           shortest(row.degrees));
    }
    return out;
}

} // namespace

int powerflow_dss(DssArguments const& arguments) {
    config::Diagnostics diagnostics;
    auto circuit =
        opendss::load_circuit(arguments.script, {arguments.include, arguments.commands, arguments.hour}, diagnostics);
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        fmt::print(stderr, "{}\n", diagnostics.render());
    }
    if (!circuit) {
        return static_cast<int>(ExitCode::usage);
    }
    opendss::CircuitOptions options;
    options.hour = arguments.hour.value_or(0);
    auto const flow = solve_circuit(*circuit, options);
    if (!flow) {
        if (arguments.json) {
            fmt::print(
                "{}\n",
                Json{{"converged", false}, {"message", flow.error().message}, {"hint", flow.error().remedy}}.dump(2));
        }
        return print_error(flow.error());
    }
    if (!flow->controls_settled) {
        fmt::print(stderr, "warning: after {} rounds the controls still act: the taps shown are not those of rest\n",
                   flow->control_rounds);
    }
    if (arguments.json) {
        print_json(*circuit, *flow);
    } else {
        print_tables(*circuit, *flow);
    }
    if (!arguments.csv.empty()) {
        if (auto const ok = launcher::write_file(arguments.csv, csv_of(*circuit, *flow)); !ok) {
            return print_error(ok.error());
        }
    }
    return 0;
}

} // namespace gridspace::cli
