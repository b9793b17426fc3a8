// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/slurm.hpp"

#include "common/text.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/sweep/run_pool.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <sys/wait.h>
#include <thread>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxArray = 1000;

struct Answer {
    int exit{0};
    std::string text;
};

/// A command of Slurm and what it said.
Answer ask(std::string const& command) {
    Answer answer{127, ""};
    std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "re");
    if (pipe == nullptr) {
        return answer;
    }
    std::array<char, 4096> buffer{};
    for (std::size_t size = 0; (size = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
        answer.text.append(buffer.data(), size);
    }
    int const status = ::pclose(pipe);
    answer.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    answer.text = trim(answer.text);
    return answer;
}

bool is_done(StudyFolder const& folder, std::string const& key) {
    auto const record = read_record(folder.record(key));
    return record && record->is_final();
}

std::string text_of(fs::path const& file) {
    std::ifstream stream{file};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

/// A job in the queue of Slurm.
class QueuedJob {
  public:
    explicit QueuedJob(std::string job) : job_{std::move(job)} {}

    /// Whether any task waits or runs. A controller that does not answer for a while is none that knows the job no
    /// more.
    Result<bool> is_there() {
        Answer const answer = ask("squeue --noheader --jobs=" + shell_word(job_));
        if (answer.exit == 0 || answer.text.find("Invalid job id") != std::string::npos) {
            silent_since_.reset();
            return answer.exit == 0 && !answer.text.empty();
        }
        auto const now = std::chrono::steady_clock::now();
        silent_since_ = silent_since_.value_or(now);
        if (answer.exit == kNoSuchCommand || now - *silent_since_ > kPatience) {
            return fail(ExitCode::environment,
                        fmt::format("nobody knows whether job {} of Slurm still runs; squeue says: {}", job_,
                                    answer.text.empty() ? "nothing" : answer.text),
                        "when Slurm answers again, the same command goes on");
        }
        return true;
    }

  private:
    static constexpr int kNoSuchCommand = 127;
    static constexpr std::chrono::minutes kPatience{10};
    std::string job_;
    std::optional<std::chrono::steady_clock::time_point> silent_since_;
};

/// Until no task of it is left in the queue; false when `seen` asks to stop, and the job is cancelled.
Result<bool> wait_for(std::string const& job, std::function<bool()> const& seen) {
    QueuedJob queued{job};
    while (true) {
        auto const there = queued.is_there();
        if (!there || !*there) {
            return there ? Result<bool>{true} : std::unexpected{there.error()};
        }
        if (!seen()) {
            (void)ask("scancel " + shell_word(job));
            return false;
        }
        std::this_thread::sleep_for(std::chrono::seconds{1});
    }
}

Result<std::string> submit(StudyFolder const& folder, std::vector<std::string> const& keys, std::size_t at_once,
                           bool keep) {
    fs::path const own = folder.root / "slurm";
    std::error_code error;
    fs::create_directories(own, error);
    for (auto const& [name, text] :
         {std::pair{"tasks", join(keys, "\n") + "\n"}, {"job.sh", job_script(folder, keys.size(), at_once, keep)}}) {
        if (auto ok = replace_file(own / name, text); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    Answer const answer = ask("sbatch --parsable " + shell_word((own / "job.sh").string()));
    if (answer.exit != 0) {
        return fail(ExitCode::environment,
                    fmt::format("Slurm does not take the job: {}", answer.text.empty() ? "no answer" : answer.text),
                    "--slurm needs Slurm's sbatch, squeue and scancel; options of sbatch are given by its environment "
                    "(SBATCH_PARTITION …)");
    }
    std::string job = answer.text.substr(0, answer.text.find(';')); // "id;cluster"
    if (auto ok = replace_file(own / "job", job); !ok) {
        return std::unexpected{ok.error()};
    }
    return job;
}

} // namespace

std::size_t array_size(std::size_t runs) {
    return std::min(runs, kMaxArray);
}

std::string job_script(StudyFolder const& folder, std::size_t runs, std::size_t at_once, bool keep) {
    std::size_t const tasks = array_size(runs);
    return fmt::format("#!/bin/sh\n"
                       "# Made by `gridspace sweep --slurm`.\n"
                       "#SBATCH --job-name=gridspace-sweep\n"
                       "#SBATCH --array=1-{0}{1}\n"
                       "#SBATCH --ntasks=1\n"
                       "#SBATCH --no-requeue\n"
                       "#SBATCH --output={2}\n"
                       "exec {3} sweep-task {4} --task \"$SLURM_ARRAY_TASK_ID\" --of {0}{5}\n",
                       tasks, at_once > 0 ? fmt::format("%{}", at_once) : "",
                       shell_word((folder.root / "slurm" / "task-%a.log").string()),
                       shell_word(program_file("gridspace").string()), shell_word(folder.root.string()),
                       keep ? " --keep" : "");
}

Result<void> run_on_slurm(StudyFolder const& folder, std::vector<std::string> const& keys, std::size_t at_once,
                          bool keep, std::function<bool()> const& seen) {
    std::vector<std::string> missing = keys;
    auto const forget_done = [&] {
        std::erase_if(missing, [&](std::string const& key) { return read_record(folder.record(key)).has_value(); });
    };
    std::string job = text_of(folder.root / "slurm" / "job"); // of a sweep that was killed
    auto const known = job.empty() ? Result<bool>{false} : QueuedJob{job}.is_there();
    if (!known) {
        return std::unexpected{known.error()};
    }
    bool is_followed = *known;
    while (!missing.empty()) {
        if (!is_followed) {
            auto submitted = submit(folder, missing, at_once, keep);
            if (!submitted) {
                return std::unexpected{submitted.error()};
            }
            job = std::move(*submitted);
        }
        std::size_t const before = missing.size();
        if (auto const over = wait_for(job, seen); !over || !*over) {
            return over ? Result<void>{} : std::unexpected{over.error()};
        }
        forget_done();
        if (missing.size() == before && !is_followed) {
            return fail(ExitCode::environment,
                        fmt::format("job {} of Slurm is over, and none of its {} runs left a result", job, before),
                        fmt::format("its tasks' output is in '{}'", (folder.root / "slurm").string()));
        }
        is_followed = false;
    }
    return {};
}

Result<void> do_task(StudyFolder const& folder, std::size_t task, std::size_t of, bool keep,
                     InterruptWatch& interrupts) {
    std::vector<std::string> keys = split(text_of(folder.root / "slurm" / "tasks"), '\n');
    std::erase_if(keys, [](std::string const& key) { return trim(key).empty(); });
    if (keys.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' has no tasks of `gridspace sweep --slurm`", folder.root.string()));
    }
    RunPool pool{1};
    for (std::size_t i = task - 1; i < keys.size(); i += of) {
        if (is_done(folder, keys[i])) {
            continue;
        }
        if (auto ok = pool.start(i, begin_run(folder, keys[i]), folder.output(keys[i])); !ok) {
            return ok;
        }
        std::optional<RunPool::Ended> ended;
        while (!ended) {
            ended = pool.wait(std::chrono::seconds{60}, interrupts.fd());
            if (interrupts.take() > 0) {
                return fail(ExitCode::interrupted, "stopped"); // the pool ends the run
            }
        }
        auto const record = end_run(folder, keys[i], ended->exit, ended->wall_s, keep);
        if (!record) {
            return std::unexpected{record.error()};
        }
    }
    return {};
}

} // namespace gridspace::launcher
