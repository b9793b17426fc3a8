// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scl/station_report.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using nlohmann::ordered_json;
using scl::Finding;
using Kind = Finding::Kind;

/// Those of the file, then those of the scenario.
std::vector<Finding> all_findings(scl::Station const& station, StationScenario const& scenario) {
    std::vector<Finding> out = station.import.findings;
    out.insert(out.end(), scenario.findings.begin(), scenario.findings.end());
    return out;
}

std::string value_of(config::Node const& stream, char const* key) {
    config::Node const* const found = stream.find(key);
    return found == nullptr ? "" : found->text;
}

config::Node const& stream_node(scl::Station const& station, std::string const& name) {
    auto const& entries = station.import.streams.entries;
    return std::find_if(entries.begin(), entries.end(), [&](auto const& e) { return e.key == name; })->value;
}

std::string heading(Kind kind) {
    return kind == Kind::left_out ? "left out" : kind == Kind::assumed ? "taken with another value" : "doubtful";
}

ordered_json json_of(Finding const& f) {
    return {{"kind", std::string{scl::kind_name(f.kind)}},
            {"line", f.where.line},
            {"column", f.where.column},
            {"subject", f.subject},
            {"text", f.text},
            {"remedy", f.remedy}};
}

} // namespace

std::size_t count_of(std::vector<Finding> const& findings, Kind kind) {
    return static_cast<std::size_t>(
        std::count_if(findings.begin(), findings.end(), [&](Finding const& f) { return f.kind == kind; }));
}

std::string findings_text(std::vector<Finding> const& findings, std::size_t dropped) {
    std::string out;
    for (Kind const kind : {Kind::left_out, Kind::assumed, Kind::doubtful}) {
        std::size_t const count = count_of(findings, kind);
        if (count == 0) {
            continue;
        }
        out += fmt::format("{} ({})\n", heading(kind), count);
        for (Finding const& f : findings) {
            if (f.kind == kind) {
                out += fmt::format("  {}: {}{}{}\n", f.where.to_string(), f.subject.empty() ? "" : f.subject + ": ",
                                   printable(f.text), f.remedy.empty() ? "" : "\n      " + printable(f.remedy));
            }
        }
    }
    return dropped == 0 ? out : out + fmt::format("  and {} more findings\n", dropped);
}

std::string report_text(scl::Station const& station, StationScenario const& scenario) {
    std::string out = fmt::format("IEDs played ({} of {})\n", scenario.ieds.size(), station.ieds.size());
    for (PlayedIed const& ied : scenario.ieds) {
        out += fmt::format("  {}: process {}; sends {}, hears {}\n", ied.ied, join(ied.processes, " and "),
                           ied.sends.size(), ied.hears.size());
    }
    out += fmt::format("streams ({})\n", scenario.streams.size());
    for (PlayedStream const& s : scenario.streams) {
        config::Node const& node = stream_node(station, s.stream);
        out += fmt::format("  {}: {} {} APPID {} confRev {}{}: {}\n", s.stream, value_of(node, "kind"),
                           scl::destination_of(node), value_of(node, "app_id"), value_of(node, "conf_rev"),
                           node.find("rate_hz") == nullptr ? "" : ", " + value_of(node, "rate_hz") + " Hz", s.values);
    }
    std::size_t refs = 0, supervised = 0;
    for (scl::StreamSubscription const& one : station.subscriptions) {
        refs += one.ext_refs;
        supervised += one.supervisor.empty() ? 0 : 1;
    }
    out += fmt::format("subscriptions ({} of {} ExtRefs; {} with LGOS or LSVS)\n", station.subscriptions.size(), refs,
                       supervised);
    if (!scenario.silent.empty()) {
        out += fmt::format("IEDs that send and hear no stream, not played ({}): {}\n", scenario.silent.size(),
                           join(scenario.silent, ", "));
    }
    return out + findings_text(all_findings(station, scenario), station.import.findings_dropped);
}

std::string report_json(scl::Station const& station, StationScenario const& scenario) {
    ordered_json root;
    root["ieds"] = ordered_json::array();
    for (PlayedIed const& ied : scenario.ieds) {
        root["ieds"].push_back(
            {{"name", ied.ied}, {"processes", ied.processes}, {"sends", ied.sends}, {"hears", ied.hears}});
    }
    root["not_played"] = scenario.silent;
    root["streams"] = ordered_json::array();
    for (PlayedStream const& s : scenario.streams) {
        config::Node const& node = stream_node(station, s.stream);
        ordered_json one{{"name", s.stream}, {"ied", s.ied}, {"control_block", s.block}, {"played", s.played}};
        for (char const* key : {"kind", "mac", "app_id", "vlan_id", "vlan_priority", "conf_rev", "rate_hz"}) {
            if (node.find(key) != nullptr) {
                one[key] = value_of(node, key);
            }
        }
        if (node.find("udp") != nullptr) {
            one["group"] = scl::destination_of(node);
        }
        one["values"] = s.values;
        root["streams"].push_back(std::move(one));
    }
    root["subscriptions"] = ordered_json::array();
    for (scl::StreamSubscription const& one : station.subscriptions) {
        root["subscriptions"].push_back({{"ied", one.ied},
                                         {"stream", station.import.blocks[one.block].stream},
                                         {"members", one.members},
                                         {"ext_refs", one.ext_refs},
                                         {"supervisor", one.supervisor}});
    }
    root["findings"] = ordered_json::array();
    for (Finding const& f : all_findings(station, scenario)) {
        root["findings"].push_back(json_of(f));
    }
    root["findings_not_kept"] = station.import.findings_dropped;
    // Names come from a file of others, which may hold any octets.
    return root.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

} // namespace gridspace::launcher
