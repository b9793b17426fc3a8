// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "timebox/box.hpp"

#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

struct TimeboxArguments {
    std::vector<std::string> command;
    std::optional<double> until_s;
    std::uint64_t seed{1};
    std::int64_t epoch_unix_s{1'575'158'400}; // as of scenarios: 2019-12-01
    double patience_s{60};
    bool trace{false}, quiet{false};
};

volatile std::sig_atomic_t stop_signal = 0;

/// Ctrl-C ends the program in the box, and not this one.
void watch_for_stop() {
    struct sigaction stop{};
    stop.sa_handler = [](int signal) { stop_signal = signal; };
    ::sigaction(SIGINT, &stop, nullptr);
    ::sigaction(SIGTERM, &stop, nullptr);
}

int timebox(TimeboxArguments const& arguments) {
    timebox::BoxOptions options;
    options.command = arguments.command;
    options.seed = arguments.seed;
    options.epoch_unix_s = arguments.epoch_unix_s;
    options.patience_s = arguments.patience_s;
    options.stop = [] { return stop_signal != 0; };
    if (arguments.trace) {
        options.on_held = [](double time_s, int thread, char const* call, double held_s) {
            fmt::print(stderr, "{:16.9f} s  thread {:<3} {:<16} held {:.9f} s\n", time_s, thread, call, held_s);
        };
    }
    auto const began = std::chrono::steady_clock::now();
    watch_for_stop();
    auto const box = timebox::Box::start(options);
    if (!box) {
        return print_error(box.error());
    }
    auto const pause = (*box)->run_until(
        arguments.until_s ? std::optional{static_cast<std::int64_t>(*arguments.until_s * 1e9)} : std::nullopt);
    if (!pause) {
        return print_error(pause.error());
    }
    if (*pause == timebox::Box::Pause::stopped) {
        return print_error({ExitCode::interrupted, "interrupted", ""});
    }
    timebox::BoxReport const report = (*box)->report();
    std::chrono::duration<double> const took = std::chrono::steady_clock::now() - began;
    for (auto const& [what, times] : report.refused) {
        fmt::print(stderr, "timebox: refused {} time{}: {}, which cannot be had in simulated time\n", times,
                   times == 1 ? "" : "s", what);
    }
    if (!arguments.quiet) {
        fmt::print(stderr,
                   "timebox: {:.9f} s simulated in {:.2f} s{}; {} threads, {} calls held, {} looks at the clock\n",
                   static_cast<double>(report.simulated_ns) / 1e9, took.count(),
                   *pause == timebox::Box::Pause::limit ? ", ended there" : "", report.threads, report.held,
                   report.clock_reads);
    }
    return report.exit_code;
}

} // namespace

void add_timebox(Command app, Action& action) {
    auto const arguments = std::make_shared<TimeboxArguments>();
    Command verb =
        app.add_subcommand("timebox", "run an unmodified program in simulated time, with the same result each time");
    verb.add_option("COMMAND", arguments->command, "the program and its arguments, behind --").required();
    verb.add_option("--until", arguments->until_s, "simulated time at which it is ended, s").check(positive());
    verb.add_option("--seed", arguments->seed, "of the random numbers that the kernel gives");
    verb.add_option("--epoch", arguments->epoch_unix_s, "what the clock shows at the start, s since 1970 (UTC)");
    verb.add_option("--patience", arguments->patience_s, "real time that it may compute without a call, s")
        .check(positive());
    verb.add_flag("--trace", arguments->trace, "list the calls that were held, with simulated times (stderr)");
    verb.add_flag("-q,--quiet", arguments->quiet, "no summary");
    verb.callback([arguments, &action] { action = [arguments] { return timebox(*arguments); }; });
}

} // namespace gridspace::cli
