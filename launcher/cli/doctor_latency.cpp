// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/doctor_latency.hpp"

#include "common/lateness_json.hpp"
#include "common/time.hpp"
#include "launcher/doctor/wakeup_latency.hpp"
#include "launcher/folder/machine_latency.hpp"
#include "launcher/run/progress_bar.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

namespace gridspace::cli {
namespace {

using launcher::Waiting;
using launcher::WakeupLatency;
using launcher::WayToWait;

std::string load_text() {
    double load[1] = {0};
    return ::getloadavg(load, 1) == 1
               ? fmt::format("load {:.2f} on {} processors", load[0], std::thread::hardware_concurrency())
               : "load unknown";
}

void print_row(WayToWait const& way, WakeupLatency const& found, double period_us) {
    std::string const name = found.processor.empty() ? way.name : fmt::format("{} ({})", way.name, found.processor);
    fmt::print("{:<21} {:>8} {:>8.1f} {:>8.1f} {:>8.1f} {:>9.1f} {:>8}\n", name, found.late_us.size(),
               found.percentile_us(0.5), found.percentile_us(0.99), found.percentile_us(0.999), found.percentile_us(1),
               found.later_than(period_us));
}

void print_classes(char const* name, WakeupLatency const& found) {
    auto const classes = launcher::lateness_classes(found.late_us);
    fmt::print("\nhow late, {}:\n", name);
    for (auto const& one : classes) {
        double const share = static_cast<double>(one.count) / static_cast<double>(found.late_us.size());
        fmt::print("{:>7.0f} to {:>6.0f} us  {:<32} {:>7}\n", one.from_us, one.below_us,
                   launcher::progress_bar(share, 32), one.count);
    }
}

nlohmann::ordered_json as_json(WayToWait const& way, WakeupLatency const& found, double period_us) {
    nlohmann::ordered_json classes = nlohmann::ordered_json::array();
    for (auto const& one : launcher::lateness_classes(found.late_us)) {
        classes.push_back({{"from_us", one.from_us}, {"below_us", one.below_us}, {"count", one.count}});
    }
    nlohmann::ordered_json out{{"waiting", way.key}, {"name", way.name}, {"processor", found.processor}};
    out.update(to_json(Lateness::Summary{period_us, found.late_us.size(), found.later_than(period_us),
                                         found.percentile_us(0.5), found.percentile_us(0.99),
                                         found.percentile_us(0.999), found.percentile_us(1)}));
    out["histogram"] = std::move(classes);
    return out;
}

} // namespace

int show_latency(LatencyQuestion const& asked) {
    auto const count = static_cast<std::size_t>(std::max(1.0, asked.seconds * 1e6 / asked.period_us));
    std::string const load = load_text();
    nlohmann::ordered_json all = {{"measured", format_utc(std::time(nullptr))},
                                  {"period_us", asked.period_us},
                                  {"seconds", asked.seconds},
                                  {"load", load}};
    if (!asked.json) {
        fmt::print("Wake-ups every {:.1f} us, {:g} s for each way to wait; {}. Late by, in microseconds:\n\n",
                   asked.period_us, asked.seconds, load);
        fmt::print("{:<21} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8}\n", "waiting", "wake-ups", "p50", "p99", "p99.9",
                   "worst", "> period");
    }
    std::optional<std::pair<char const*, WakeupLatency>> plain, best;
    for (WayToWait const& way : launcher::kWaysToWait) {
        auto found = launcher::measure_wakeups(
            way.waiting, std::chrono::nanoseconds{static_cast<std::int64_t>(asked.period_us * 1e3)}, count);
        all["ways"].push_back(
            found ? as_json(way, *found, asked.period_us)
                  : nlohmann::ordered_json{{"waiting", way.key}, {"not_permitted", found.error().message}});
        if (asked.json) {
            continue;
        }
        if (found) {
            print_row(way, *found, asked.period_us);
        } else {
            fmt::print("{:<21} {}\n", way.name, found.error().message);
        }
        std::fflush(stdout);
        if (found && way.waiting != Waiting::polling) {
            (plain ? best : plain) = {way.name, std::move(*found)};
        }
    }
    auto const kept = launcher::keep_machine_latency(all);
    if (asked.json) {
        fmt::print("{}\n", all.dump(2));
        return 0;
    }
    for (auto const& one : {plain, best}) {
        if (one) {
            print_classes(one->first, one->second);
        }
    }
    fmt::print("\nEach row is the one above it and one thing more. A run in real time gives its processes SCHED_FIFO "
               "and locks\n"
               "their memory where it may. Busy polling takes a whole processor, of which the kernel takes some of "
               "each second\n"
               "back: sysctl kernel.sched_rt_runtime_us.\n{}\n",
               kept ? fmt::format("Reports of runs in real time show it from now on (kept in {}).", kept->string())
                    : "Not kept for the reports of runs: " + kept.error().message);
    return 0;
}

} // namespace gridspace::cli
