// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/worst_runs.hpp"

#include "launcher/sweep/run_pool.hpp"

#include <algorithm>
#include <filesystem>
#include <span>

namespace gridspace::launcher {

Result<void> keep_worst(std::vector<GroupResult>& groups, Certificate const& certificate, std::size_t jobs,
                        InterruptWatch& interrupts) {
    std::vector<WorstFault const*> tasks;
    for (WorstFault const& fault : certificate.worst) {
        GroupResult const& group = groups[fault.group];
        if (group.plan.lockstep && !group.finished.records[fault.run]->is_kept) {
            tasks.push_back(&fault);
        }
    }
    RunPool pool{std::max<std::size_t>(std::min(jobs, tasks.size()), 1)};
    std::size_t next = 0;
    bool stops = false;
    while ((next < tasks.size() && !stops) || pool.running() > 0) {
        while (next < tasks.size() && !stops && pool.has_room()) {
            GroupResult const& group = groups[tasks[next]->group];
            std::string const& key = group.plan.runs[tasks[next]->run].key;
            StudyFolder const& folder = group.finished.folder;
            if (auto ok = pool.start(next, begin_run(folder, key), folder.output(key)); !ok) {
                return ok;
            }
            ++next;
        }
        if (auto const ended = pool.wait(std::chrono::seconds{1}, interrupts.fd()); ended && !stops) {
            GroupResult& group = groups[tasks[ended->task]->group];
            std::size_t const run = tasks[ended->task]->run;
            auto record = end_run(group.finished.folder, group.plan.runs[run].key, ended->exit, ended->wall_s, true);
            if (!record) {
                return std::unexpected{record.error()};
            }
            group.finished.records[run] = std::move(*record);
        }
        if (interrupts.take() > 0 && !stops) {
            stops = true;
            pool.interrupt();
        }
    }
    if (!stops) {
        return {};
    }
    for (WorstFault const* task : std::span{tasks}.first(next)) { // those that did not end have their result of before
        GroupResult const& group = groups[task->group];
        std::string const& key = group.plan.runs[task->run].key;
        if (auto const& record = group.finished.records[task->run]; !record->is_kept) {
            std::error_code ignored;
            std::filesystem::remove_all(group.finished.folder.run(key), ignored);
            if (auto ok = write_record(group.finished.folder.record(key), *record); !ok) {
                return ok;
            }
        }
    }
    return fail(ExitCode::interrupted, "stopped", "the same command goes on where it stopped");
}

} // namespace gridspace::launcher
