// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/recorded_run.hpp"

#include "common/log.hpp"
#include "monitor/graph/graph_text.hpp"
#include "recorder/mcap/mcap_reader.hpp"

#include <fstream>
#include <iterator>
#include <set>

namespace gridspace::monitor {

RecordedRun::RecordedRun(std::filesystem::path recording, LiveRun& run) : run_{run} {
    std::ifstream stream{run.plan.graph};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    std::lock_guard const lock{run.mutex};
    run.recorded_graph = graph::from_json(text);
    if (run.recorded_graph) {
        for (graph::Process& process : run.recorded_graph->processes) { // whoever was there to the end is not any more
            process.state = process.state == graph::ProcessState::alive ? graph::ProcessState::ended : process.state;
        }
    }
    run.recorded = true;
    run.clock.state = "loading";
    run.clock.time_s = 0;
    thread_ = std::thread{[this, file = std::move(recording)] { load(file); }};
}

RecordedRun::~RecordedRun() {
    ending_ = true;
    thread_.join();
}

void RecordedRun::load(std::filesystem::path const& recording) {
    std::set<std::string> seen;
    std::map<std::string, std::string> networks; // by topic
    if (run_.recorded_graph) {
        for (graph::Topic const& topic : run_.recorded_graph->topics) {
            networks.try_emplace(topic.name, topic.network);
        }
    }
    auto const outcome = mcap::read_messages(recording, [&](mcap::Message const& message) {
        auto const process = message.channel.metadata.find("process");
        std::string const name = process == message.channel.metadata.end() ? std::string{} : process->second;
        if (seen.insert(name + '\n' + message.channel.topic).second) {
            std::lock_guard const lock{run_.mutex};
            run_.idl.try_emplace(message.schema.name, message.schema.data);
            if (!run_.recorded_graph && seen.insert(name).second) { // no monitor has seen who else was there
                run_.graph.participant_found("recording", {name, {name, 0, "recorded"}, {}});
                run_.graph.participant_gone(name, true);
            }
        }
        auto const network = networks.find(message.channel.topic);
        run_.on_sample(network == networks.end() ? "recording" : network->second, message.channel.topic,
                       message.schema.name, name, message.data, static_cast<std::int64_t>(message.time_ns));
        return !ending_;
    });
    if (!outcome) {
        log::error("{}", describe(outcome.error()));
    } else if (!outcome->complete) {
        log::warning("the recording is not complete: {}", outcome->note);
    }
    std::lock_guard const lock{run_.mutex};
    run_.clock.state = "recorded";
    run_.clock.factor = 0;
    for (auto& [key, state] : run_.topics) { // the mean of the run
        state.per_second = run_.clock.time_s > 0 ? static_cast<double>(state.samples) / run_.clock.time_s : 0;
    }
}

} // namespace gridspace::monitor
