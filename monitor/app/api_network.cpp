// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/api.hpp"
#include "monitor/diagram/picture.hpp"

#include <nlohmann/json.hpp>

namespace gridspace::monitor {

namespace {

using Json = nlohmann::ordered_json;

/// Beyond it nobody sees anything, and the picture fills the queues of slow clients.
constexpr std::size_t kMostDrawn = 2000;

Json relays_json(RunPlan const& plan) {
    Json relays = Json::array();
    auto const names = [](std::vector<config::Ref> const& refs) {
        Json out = Json::array();
        for (config::Ref const& ref : refs) {
            out.push_back(ref.name);
        }
        return out;
    };
    for (auto const& r : plan.relays) {
        relays.push_back({{"name", r.name},
                          {"functions", names(r.functions)},
                          {"cts", names(r.cts)},
                          {"breakers", names(r.breakers)}});
    }
    return relays;
}

Json faults_json(RunPlan const& plan) {
    Json faults = Json::array();
    for (auto const& fault : plan.faults) {
        Json entry{{"name", fault.name}, {"at_s", fault.at_s}};
        if (fault.line.empty()) {
            entry["bus"] = fault.bus;
        } else {
            entry["line"] = fault.line;
            entry["position_percent"] = fault.position_percent;
        }
        if (fault.until_s) {
            entry["until_s"] = *fault.until_s;
        }
        faults.push_back(std::move(entry));
    }
    return faults;
}

} // namespace

std::string Api::network() const {
    RunPlan const& plan = run_.plan;
    Json buses = Json::array(), branches = Json::array(), breakers = Json::array(), devices = Json::array();
    for (auto const& bus : plan.buses) {
        Json entry{{"name", bus.name}, {"label", bus.label}, {"voltage_v", bus.voltage_v}};
        if (bus.x && bus.y) {
            entry["x"] = *bus.x;
            entry["y"] = *bus.y;
        }
        buses.push_back(std::move(entry));
    }
    for (auto const& b : plan.branches) {
        branches.push_back({{"name", b.name}, {"label", b.label}, {"from", b.from}, {"to", b.to}, {"kind", b.kind}});
    }
    for (auto const& b : plan.breakers) {
        breakers.push_back({{"name", b.name}, {"line", b.line}, {"end", b.end}});
    }
    Json cts = Json::array();
    for (auto const& ct : plan.cts) {
        cts.push_back({{"name", ct.name}, {"line", ct.line}, {"end", ct.end}});
    }
    for (auto const& d : plan.devices) {
        devices.push_back({{"name", d.name}, {"label", d.label}, {"bus", d.bus}, {"kind", d.kind}});
    }
    Json const out{
        {"diagram", plan.elements() > kMostDrawn ? std::string{} : diagram::one_line(plan, {nullptr, true}).svg},
        {"frequency_hz", plan.frequency_hz},
        {"buses", buses},
        {"branches", branches},
        {"breakers", breakers},
        {"cts", cts},
        {"devices", devices},
        {"relays", relays_json(plan)},
        {"faults", faults_json(plan)}};
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace gridspace::monitor
