// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_plan.hpp"

#include "launcher/sweep/run_key.hpp"
#include "launcher/sweep/study_check.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

/// Expectations of the scenario that the study does not want.
std::vector<std::string> unwanted_expectations(Study const& study, Scenario const& scenario) {
    std::vector<std::string> out;
    for (Node::Entry const& entry : scenario.expect.entries) {
        if (study.expectations && std::find(study.expectations->begin(), study.expectations->end(),
                                            Ref{entry.key, {}}) == study.expectations->end()) {
            out.push_back(entry.key);
        }
    }
    return out;
}

std::vector<StudyRun> runs_of(Study const& study, std::vector<Point>& points, Scenario const& base) {
    std::vector<StudyRun> runs;
    std::vector<std::string> const unwanted = unwanted_expectations(study, base);
    for (Point& point : points) {
        for (std::int64_t repetition = 1; repetition <= study.repetitions; ++repetition) {
            StudyRun run;
            run.point = point;
            run.repetition = repetition;
            run.overlay = overlay_of(study, point,
                                     study.repetitions > 1 ? std::to_string(base.seed + repetition - 1) : "", unwanted);
            runs.push_back(std::move(run));
        }
    }
    return runs;
}

} // namespace

std::string describe(Study const& study, StudyRun const& run) {
    std::string out;
    for (std::size_t i = 0; i < run.point.size(); ++i) {
        out +=
            fmt::format("{}{} = {}", out.empty() ? "" : ", ", study.parameters[i].name.name, cell_text(run.point[i]));
    }
    if (study.repetitions > 1) {
        out += fmt::format("{}repetition {}", out.empty() ? "" : ", ", run.repetition);
    }
    return out.empty() ? "the only run" : out;
}

std::optional<StudyPlan> plan_study(Study const& study, Diagnostics& diagnostics, RunCheck const& check) {
    auto const base = load_base(study, diagnostics);
    if (!base) {
        return std::nullopt;
    }
    check_study(study, *base, diagnostics);
    Design design = make_design(study, diagnostics);
    if (!diagnostics.ok()) {
        return std::nullopt;
    }
    StudyPlan plan;
    plan.left_out = design.left_out;
    plan.runs = runs_of(study, design.points, *base->scenario);
    RunKeys keys{study.depends_on};
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        StudyRun& run = plan.runs[i];
        Diagnostics own;
        auto const scenario = load_scenario(study.scenario, {.over = &run.overlay}, own);
        if (scenario && check) {
            check(*scenario, own);
        }
        for (config::Diagnostic const& d : own.sorted()) {
            if (d.severity == config::Severity::error) {
                diagnostics.error(d.where, d.message, d.hint, d.width);
            } else if (i == 0) { // the same of all of them
                diagnostics.warning(d.where, d.message, d.hint, d.width);
            }
        }
        if (!scenario || !own.ok()) {
            diagnostics.error(
                study.parameters_mark,
                fmt::format("run {} of {} cannot be done: {}", i + 1, plan.runs.size(), describe(study, run)),
                i == 0 ? "" : "`where` leaves out what does not go together");
            return std::nullopt;
        }
        run.key = keys.key_of(*scenario);
        run.seed = scenario->seed;
        if (i == 0) {
            plan.scenario = scenario->name;
            for (Node::Entry const& entry : scenario->expect.entries) {
                plan.results.push_back(entry.key);
            }
            plan.lockstep = scenario->clock.mode == bus::ClockMode::lockstep;
        }
    }
    return plan;
}

} // namespace gridspace::launcher
