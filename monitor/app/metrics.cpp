// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/metrics.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::monitor {
namespace {

std::string label(std::string const& text) {
    std::string out;
    for (char const c : text) {
        out += c == '\n' ? "\\n" : c == '"' ? "\\\"" : c == '\\' ? "\\\\" : std::string{c};
    }
    return out;
}

std::string value(double v) {
    return std::isnan(v) ? "NaN" : std::isinf(v) ? (v > 0 ? "+Inf" : "-Inf") : fmt::format("{}", v);
}

void head(std::string& out, char const* name, char const* kind, char const* help) {
    out += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, kind);
}

} // namespace

std::string metrics_text(LiveRun const& run, web::ServerCounters const& server) {
    std::string out;
    auto const one = [&](char const* name, char const* kind, char const* help, double v) {
        head(out, name, kind, help);
        out += fmt::format("{} {}\n", name, value(v));
    };
    std::lock_guard const lock{run.mutex};
    one("gridspace_simulated_seconds", "gauge", "Simulated time.", run.clock.time_s);
    one("gridspace_duration_seconds", "gauge", "Simulated time at which the run ends.", run.plan.duration_s);
    one("gridspace_pace_ratio", "gauge", "Simulated seconds per second, lately.", run.clock.factor);
    one("gridspace_events_total", "counter", "Events of the run.", static_cast<double>(run.events_seen));
    one("gridspace_undecodable_samples_total", "counter",
        "Samples that were not what their type says; of types that come as IDL the newest of a topic, twice a second.",
        static_cast<double>(run.undecodable));
    head(out, "gridspace_process_up", "gauge", "1 while the process is on the bus.");
    graph::Snapshot const& graph = run.snapshot();
    for (graph::Process const& process : graph.processes) {
        out += fmt::format("gridspace_process_up{{process=\"{}\",program=\"{}\",host=\"{}\"}} {}\n",
                           label(process.name), label(process.program), label(process.host),
                           process.state == graph::ProcessState::alive ? 1 : 0);
    }
    head(out, "gridspace_process_cpu_seconds_total", "counter", "Processor time of a process of this machine.");
    for (auto const& [name, use] : run.use) {
        out += fmt::format("gridspace_process_cpu_seconds_total{{process=\"{}\"}} {}\n", label(name), use.cpu_s);
    }
    head(out, "gridspace_process_resident_memory_bytes", "gauge", "What a process of this machine has in memory.");
    for (auto const& [name, use] : run.use) {
        if (use.memory_octets) {
            out += fmt::format("gridspace_process_resident_memory_bytes{{process=\"{}\"}} {}\n", label(name),
                               *use.memory_octets);
        }
    }
    head(out, "gridspace_topic_samples_total", "counter", "Samples seen by the monitor.");
    for (auto const& [key, topic] : run.topics) {
        out += fmt::format("gridspace_topic_samples_total{{topic=\"{}\",network=\"{}\"}} {}\n", label(topic.topic),
                           label(topic.network), topic.samples);
    }
    for (graph::Topic const& topic : graph.topics) {
        if (!run.topics.contains({topic.network, topic.name})) { // nothing has been heard of it yet
            out += fmt::format("gridspace_topic_samples_total{{topic=\"{}\",network=\"{}\"}} 0\n", label(topic.name),
                               label(topic.network));
        }
    }
    head(out, "gridspace_signal", "gauge", "Newest value of a signal.");
    for (auto const& [key, window] : run.signals) {
        for (std::size_t c = 0; window != nullptr && !window->empty() && c < window->columns().size(); ++c) {
            out += fmt::format("gridspace_signal{{name=\"{}\",unit=\"{}\"}} {}\n", label(window->columns()[c].name),
                               label(window->columns()[c].unit), value(window->newest(c)));
        }
    }
    one("gridspace_monitor_requests_total", "counter", "HTTP requests.", static_cast<double>(server.requests));
    one("gridspace_monitor_refused_total", "counter", "Requests and connections refused.",
        static_cast<double>(server.refused));
    one("gridspace_monitor_connections", "gauge", "Open connections.", static_cast<double>(server.connections));
    one("gridspace_monitor_push_clients", "gauge", "Open WebSockets.", static_cast<double>(server.push_clients));
    one("gridspace_monitor_pushed_total", "counter", "Messages pushed.", static_cast<double>(server.pushed));
    one("gridspace_monitor_dropped_total", "counter", "Messages dropped for slow clients.",
        static_cast<double>(server.dropped));
    return out;
}

} // namespace gridspace::monitor
