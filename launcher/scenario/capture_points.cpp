// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/capture_points.hpp"

#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::launcher {
namespace {

bool is_lockstep(Scenario const& scenario) {
    return scenario.clock.mode == bus::ClockMode::lockstep;
}

/// Whether a process of the run sends raw frames into the link.
bool has_frames(Scenario const& scenario, std::string const& link) {
    return std::any_of(scenario.processes.begin(), scenario.processes.end(), [&](Process const& process) {
        if (process.settings == nullptr) {
            return false;
        }
        auto const uses = frames_sent(scenario, process);
        return std::any_of(uses.begin(), uses.end(), [&](WireUse const& use) { return use.link == link; });
    });
}

std::vector<std::string> captured_links(Scenario const& scenario, Process const& recorder) {
    std::vector<std::string> out;
    for (Link const& link : scenario.links) {
        bool const named =
            std::any_of(recorder.capture.begin(), recorder.capture.end(), [&](Ref const& r) { return r == link.name; });
        bool const unasked =
            recorder.capture.empty() && (!is_lockstep(scenario) || has_frames(scenario, link.name.name));
        if (named || unasked) {
            out.push_back(link.name.name);
        }
    }
    return out;
}

bool contains(std::vector<std::string> const& names, std::string const& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

std::vector<CapturePoint> capture_points(Scenario const& scenario, Process const& recorder) {
    std::vector<CapturePoint> out;
    bool const frames = !scenario.streams.empty() ||
                        std::any_of(scenario.links.begin(), scenario.links.end(),
                                    [&](Link const& link) { return has_frames(scenario, link.name.name); });
    if (scenario.record.frames != "all" || !frames) {
        return out;
    }
    std::vector<std::string> const links = captured_links(scenario, recorder);
    std::vector<Port> const ports = plan_ports(scenario);
    for (std::size_t i = 0; i < ports.size(); ++i) {
        if (contains(links, ports[i].link)) {
            std::string const name = ports[i].link + "/" + ports[i].host;
            out.push_back(
                {name, fmt::format("what is sent into {}", name), "", switch_port_name(i), ports[i].link, false, ""});
        }
    }
    for (PlacedBump const& bump : placed_bumps(scenario)) {
        if (!contains(links, bump.link)) {
            continue;
        }
        out.push_back(
            {fmt::format("{}/{}:{}", bump.link, bump.host, bump.process),
             fmt::format("between {} and {} in its cable: inbound is what {} sent", bump.host, bump.process, bump.host),
             bump.process_host, bump.host_interface, bump.from_host ? bump.from_host->in : "", true,
             bump.to_host ? bump.to_host->out : ""});
    }
    std::set<std::string> real;
    for (Process const& process : scenario.processes) {
        if (!process.interface.empty() && real.insert(process.interface).second) {
            out.push_back({fmt::format("{}/{}", process.host.name, process.interface),
                           fmt::format("interface {} of the machine, in host {}: inbound is what came in",
                                       process.interface, process.host.name),
                           process.host.name, process.interface, "", true, ""});
        }
    }
    return out;
}

void check_capture(Scenario const& scenario, Process const& recorder, config::Diagnostics& diagnostics) {
    std::vector<std::string> names;
    for (Link const& link : scenario.links) {
        names.push_back(link.name.name);
    }
    for (Ref const& link : recorder.capture) {
        if (is_lockstep(scenario) && contains(names, link.name) && !has_frames(scenario, link.name)) {
            diagnostics.warning(
                link.where,
                fmt::format(
                    "nothing of '{}' will be captured: no process sends SV, GOOSE or IP in simulated time there",
                    link.name),
                "in lockstep other frames have no place in simulated time; what DDS carried is in data.mcap",
                static_cast<int>(link.name.size()));
        }
    }
}

} // namespace gridspace::launcher
