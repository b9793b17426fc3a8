// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/sweep.hpp"

#include "launcher/folder/write_file.hpp"
#include "launcher/sweep/run_pool.hpp"
#include "launcher/sweep/slurm.hpp"
#include "launcher/sweep/study_page.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <set>
#include <sys/file.h>
#include <thread>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// One sweep at a time in a folder; the lock goes with the process, however it ends.
Result<UniqueFd> take_folder(fs::path const& root, bool resume) {
    std::error_code error;
    if (resume && !fs::is_directory(root / "runs", error)) {
        return fail(ExitCode::usage, fmt::format("there is nothing to resume in '{}'", root.string()),
                    "leave --resume out to begin, or name the folder with --out");
    }
    fs::create_directories(root / "runs", error);
    UniqueFd lock{::open((root / "study.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)};
    if (error || !lock) {
        return fail(
            ExitCode::environment,
            fmt::format("cannot write in '{}': {}", root.string(), error ? error.message() : std::strerror(errno)),
            "choose another folder with --out");
    }
    // A sweep that was killed a moment ago may still have a child that is about to end.
    for (int tries = 0; ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0; ++tries) {
        if (tries < 20) {
            std::this_thread::sleep_for(std::chrono::milliseconds{100});
            continue;
        }
        return fail(ExitCode::environment, fmt::format("another sweep is at work in '{}'", root.string()),
                    "wait for it, or choose another folder with --out");
    }
    return lock;
}

class Sweep {
  public:
    Sweep(Study const& study, StudyPlan const& plan, SweepOptions const& options, SweepListener const& listener,
          InterruptWatch& interrupts)
        : study_{study}, plan_{plan}, options_{options}, listener_{listener}, interrupts_{interrupts} {
        finished_.folder.root = fs::absolute(options.out).lexically_normal();
    }

    Result<FinishedSweep> run() {
        auto const lock = take_folder(finished_.folder.root, options_.resume);
        if (!lock) {
            return std::unexpected{lock.error()};
        }
        finished_.records = read_records(plan_, finished_.folder);
        find_tasks();
        begin_ = Clock::now();
        options_.slurm ? do_on_slurm() : do_here();
        finished_.wall_s = std::chrono::duration<double>(Clock::now() - begin_).count();
        show(true);
        if (auto ok = write_results(); !ok) {
            return std::unexpected{ok.error()};
        }
        return std::move(finished_);
    }

  private:
    StudyFolder const& folder() const { return finished_.folder; }

    /// Runs of the same key are one; what is there is not done again, but for what ended early.
    void find_tasks() {
        std::set<std::string> taken;
        for (std::size_t i = 0; i < plan_.runs.size(); ++i) {
            std::string const& key = plan_.runs[i].key;
            if (finished_.records[i] && finished_.records[i]->is_final()) {
                ++finished_.found;
            } else if (taken.insert(key).second) {
                tasks_.push_back(i);
            }
            std::error_code ignored;
            if (finished_.records[i] && !finished_.records[i]->is_kept) { // a sweep was killed before it could
                fs::remove_all(folder().run(key), ignored);
            }
        }
    }

    void do_here() {
        RunPool pool{std::max<std::size_t>(options_.jobs, 1)};
        std::size_t next = 0;
        auto const may_start = [&] { return next < tasks_.size() && !finished_.is_interrupted && !finished_.stopped; };
        while (may_start() || pool.running() > 0) {
            while (may_start() && pool.has_room()) {
                std::string const& key = plan_.runs[tasks_[next]].key;
                auto ok = write_scenario(tasks_[next]);
                if (ok) {
                    ok = pool.start(tasks_[next], begin_run(folder(), key), folder().output(key));
                }
                if (!ok) {
                    finished_.stopped = ok.error();
                }
                ++next;
            }
            if (auto const ended = pool.wait(std::chrono::seconds{1}, interrupts_.fd())) {
                take(*ended);
            }
            if (int const asked = interrupts_.take(); asked > 0) {
                if (finished_.is_interrupted || asked > 1) {
                    return; // the pool ends what still runs at once
                }
                finished_.is_interrupted = true;
                listener_.note("stopping: runs that are under way are thrown away (once more: at once)");
                pool.interrupt();
            }
            show(false);
        }
    }

    Result<void> write_scenario(std::size_t task) const {
        StudyRun const& run = plan_.runs[task];
        std::error_code error;
        fs::create_directories(folder().of_run(run.key), error);
        return replace_file(folder().scenario(run.key), overlay_file(study_, run.overlay));
    }

    void take(RunPool::Ended const& ended) {
        std::string const& key = plan_.runs[ended.task].key;
        if (finished_.is_interrupted && ended.exit != 0 &&
            ended.exit != static_cast<int>(ExitCode::expectation_failed)) {
            std::error_code ignored;
            fs::remove_all(folder().run(key), ignored);
            return;
        }
        auto const record = end_run(folder(), key, ended.exit, ended.wall_s, options_.keep);
        if (record) {
            note(ended.task, *record);
        } else {
            finished_.stopped = record.error();
        }
    }

    /// A run is done: runs with the same key have its record.
    void note(std::size_t task, RunRecord const& record) {
        std::string const& key = plan_.runs[task].key;
        ++done_;
        failed_ += record.exit == 0 ? 0 : 1;
        if (record.exit > 1) {
            listener_.note(fmt::format("run {} ended early, with code {}: {}\n  {}\n  again: {}", task + 1, record.exit,
                                       record.cause, describe(study_, plan_.runs[task]), folder().command(key)));
        }
        if (record.exit == static_cast<int>(ExitCode::environment)) {
            finished_.stopped = Error{ExitCode::environment,
                                      "a run lacked something of this machine, and the next would too: " + record.cause,
                                      "`gridspace doctor` says what helps; the same command goes on"};
        }
        for (std::size_t i = 0; i < plan_.runs.size(); ++i) {
            if (plan_.runs[i].key == key) {
                finished_.records[i] = record;
            }
        }
    }

    /// Slurm has the runs; here only their records are seen to come.
    void do_on_slurm() {
        std::vector<std::string> keys;
        for (std::size_t const task : tasks_) {
            std::error_code ignored;
            keys.push_back(plan_.runs[task].key);
            if (read_record(folder().record(keys.back()))) { // of a run that ended early
                fs::remove(folder().record(keys.back()), ignored);
            }
            if (auto ok = write_scenario(task); !ok) {
                finished_.stopped = ok.error();
                return;
            }
        }
        std::vector<std::size_t> waiting = tasks_;
        auto const look = [&] {
            std::erase_if(waiting, [&](std::size_t task) {
                auto const record = read_record(folder().record(plan_.runs[task].key));
                if (record) {
                    note(task, *record);
                }
                return record.has_value();
            });
            show(false);
            finished_.is_interrupted = finished_.is_interrupted || interrupts_.take() > 0;
            return !finished_.is_interrupted && !finished_.stopped;
        };
        if (auto ok = run_on_slurm(folder(), keys, options_.jobs, options_.keep, look); !ok) {
            finished_.stopped = ok.error();
        }
        look();
    }

    void show(bool last) const {
        SweepProgress at{done_, tasks_.size(), failed_, std::nullopt};
        if (done_ > 0) {
            double const took = std::chrono::duration<double>(Clock::now() - begin_).count();
            at.left_s = took / static_cast<double>(done_) * static_cast<double>(tasks_.size() - done_);
        }
        listener_.progress(at, last);
    }

    Result<void> write_results() const {
        ResultTable const table = make_table(study_, plan_, finished_.records, folder());
        if (auto ok = replace_file(folder().root / "results.csv", to_csv(table)); !ok) {
            return ok;
        }
        if (auto ok = write_database(folder().root / "results.sqlite", table); !ok) {
            return ok;
        }
        return replace_file(folder().root / "index.html", study_page(study_, plan_, finished_.records, folder()));
    }

    Study const& study_;
    StudyPlan const& plan_;
    SweepOptions const& options_;
    SweepListener const& listener_;
    InterruptWatch& interrupts_;
    FinishedSweep finished_;
    std::vector<std::size_t> tasks_; ///< places of runs
    std::size_t done_{0}, failed_{0};
    Clock::time_point begin_;
};

} // namespace

std::size_t FinishedSweep::count(std::string_view state) const {
    return static_cast<std::size_t>(std::count_if(records.begin(), records.end(), [&](auto const& record) {
        return state == (record ? record->state() : "open");
    }));
}

int FinishedSweep::exit_code() const {
    if (stopped) {
        return static_cast<int>(stopped->code);
    }
    if (is_interrupted) {
        return static_cast<int>(ExitCode::interrupted);
    }
    int code = 0; // an early end wins over a failed expectation, as of one run
    for (auto const& record : records) {
        code = std::max(code, record ? record->exit : 0);
    }
    return code > 5 ? static_cast<int>(ExitCode::child_died) : code;
}

std::vector<std::optional<RunRecord>> read_records(StudyPlan const& plan, StudyFolder const& folder) {
    std::vector<std::optional<RunRecord>> out;
    for (StudyRun const& run : plan.runs) {
        out.push_back(read_record(folder.record(run.key)));
    }
    return out;
}

Result<FinishedSweep> sweep(Study const& study, StudyPlan const& plan, SweepOptions const& options,
                            SweepListener const& listener, InterruptWatch& interrupts) {
    return Sweep{study, plan, options, listener, interrupts}.run();
}

} // namespace gridspace::launcher
