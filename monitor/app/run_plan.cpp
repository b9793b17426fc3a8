// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/run_plan.hpp"

namespace gridspace::monitor {
namespace {

template <class T>
void list(config::Fields& f, std::string_view key, std::string_view doc, std::vector<T>& out, auto const& body) {
    f.list(key, {.doc = doc}, [&](config::Fields& item) {
        T entry;
        body(item, entry);
        out.push_back(std::move(entry));
    });
}

void describe_run(config::Fields& f, RunPlan& run) {
    f.text("mode", run.mode, {.doc = "lockstep or realtime"});
    f.text("speed", run.speed, {.doc = "simulated seconds per second, or max"});
    f.number("duration_s", run.duration_s, {.doc = "simulated time at which the run ends", .min = 0});
    f.file("events", run.events, {.doc = "the log of events that the launcher writes"});
    f.file("graph", run.graph, {.doc = "where the graph is kept for the recorded run"});
    list(f, "processes", "who takes part", run.processes, [](config::Fields& p, RunPlan::Process& out) {
        p.text("name", out.name, {.required = true});
        p.text("program", out.program);
        p.text("host", out.host);
        p.file("pid_file", out.pid_file,
               {.doc = "where the launcher notes its process identifier, while it runs here"});
    });
    list(f, "wires", "raw frames that a process sends or receives", run.wires,
         [](config::Fields& w, RunPlan::Wire& out) {
             w.text("process", out.process, {.required = true});
             w.text("stream", out.stream, {.required = true});
             w.text("kind", out.kind);
             w.text("link", out.link);
             w.flag("sends", out.sends);
         });
    diagram::describe(f, run);
    list(f, "expectations", "of the scenario", run.expectations, [](config::Fields& e, RunPlan::Expectation& out) {
        e.text("name", out.name, {.required = true});
        e.text("rule", out.rule);
        e.text("accepted", out.accepted);
        e.text("unit", out.unit);
        e.flag("advisory", out.advisory);
    });
}

} // namespace

void describe(config::Fields& f, MonitorConfig& config) {
    describe(f, static_cast<AccessConfig&>(config));
    f.file("recording", config.recording, {.doc = "the recording of a finished run, which is shown instead of a bus"});
    f.file("control_token", config.control_token,
           {.doc = "file with the secret of whoever may control the run; written by `gridspace run --allow-control`"});
    f.list("types", {.doc = "types of the scenario's own programs; filled in by `gridspace run`"},
           [&](config::Fields& t) {
               std::string name;
               t.text("name", name, {.doc = "name of the type on the wire", .required = true});
               t.file("idl", config.types[name], {.doc = "IDL file that defines the type", .required = true});
           });
    f.text("scenario", config.run.scenario, {.doc = "name of the scenario"});
    f.object("run", {.doc = "the run; filled in by `gridspace run`"},
             [&](config::Fields& r) { describe_run(r, config.run); });
}

} // namespace gridspace::monitor
