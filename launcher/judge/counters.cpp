// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/counters.hpp"

#include "common/text.hpp"
#include "launcher/judge/process_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace gridspace::launcher {
namespace {

/// Adds up over the ends; gives the time of the last row before each of them.
std::vector<std::int64_t> continue_counter(SignalSeries& series, std::vector<ProcessEnd> const& ends) {
    std::vector<std::int64_t> last_rows(ends.size(), 0);
    double before = 0, raw = 0; // of the incarnations before; the row before, as it was recorded
    std::size_t next = 0;
    for (std::size_t i = 0; i < series.values.size(); ++i) {
        bool const fell = series.values[i] < raw;
        bool restarted = false;
        for (; next < ends.size() &&
               (series.times_ns[i] > ends[next].time_ns || (fell && series.times_ns[i] == ends[next].time_ns));
             ++next) {
            restarted = true; // a row of the very instant is the old one's while it does not fall
        }
        before += restarted ? raw : 0;
        for (std::size_t later = next; later < ends.size(); ++later) {
            last_rows[later] = series.times_ns[i];
        }
        raw = series.values[i];
        series.values[i] += before;
    }
    return last_rows;
}

} // namespace

bool is_counter(std::string_view signal) {
    static constexpr std::array<std::string_view, 15> kPatterns{
        "stream.*.received", "stream.*.lost",     "stream.*.duplicate",    "stream.*.late",    "stream.*.invalid",
        "publisher.*.sent",  "publisher.*.late",  "publisher.*.underruns", "link.*.seen",      "link.*.lost",
        "link.*.delayed",    "link.*.duplicated", "link.*.reordered",      "link.*.corrupted", "first_line.*.*.*"};
    return std::any_of(kPatterns.begin(), kPatterns.end(), [&](std::string_view pattern) {
        return matches_glob(std::string{pattern}, std::string{signal});
    });
}

std::string CounterGap::to_string() const {
    return fmt::format("what {} counted from {} s to {} s", process, shortest(from_s), shortest(until_s));
}

CounterGaps continue_counters(SignalStore& signals, std::map<std::string, std::set<std::string>> const& published,
                              std::vector<LoggedEvent> const& events) {
    CounterGaps out;
    for (auto const& [process, names] : published) {
        std::vector<ProcessEnd> const ends = ends_of(process, events);
        for (std::string const& name : names) {
            auto const it = signals.find(name);
            if (it == signals.end() || !is_counter(name)) {
                continue;
            }
            bool const shared = std::any_of(published.begin(), published.end(), [&](auto const& other) {
                return other.first != process && other.second.contains(name);
            });
            SignalSeries copy = it->second;
            std::vector<std::int64_t> const last_rows = continue_counter(copy, ends);
            if (!shared) { // of two that count the same stream nobody knows whose row is whose
                it->second = std::move(copy);
            }
            for (std::size_t i = 0; i < ends.size(); ++i) {
                if (last_rows[i] < ends[i].time_ns) {
                    out[name].push_back(
                        {process, static_cast<double>(last_rows[i]) / 1e9, static_cast<double>(ends[i].time_ns) / 1e9});
                }
            }
        }
    }
    return out;
}

void mind_gaps(Expectation const& expectation, CounterGaps const& gaps, ExpectationResult& result) {
    using Verb = Expectation::Verb;
    bool const grows = expectation.verb == Verb::last_of || expectation.verb == Verb::max_of;
    bool const decided = expectation.verb == Verb::eventually || expectation.verb == Verb::time_of ||
                         expectation.verb == Verb::count_of ||
                         (grows && expectation.expression && expectation.expression->is_plain_signal() &&
                          result.band.low && !result.band.high);
    if (result.status != ExpectationResult::Status::passed || decided || !expectation.expression) {
        return;
    }
    std::set<std::string> missing;
    for (std::string const& pattern : expectation.expression->signals()) {
        for (auto const& [signal, of_signal] : gaps) {
            for (CounterGap const& gap : of_signal) {
                if (matches_glob(pattern, signal)) {
                    missing.insert(gap.to_string());
                }
            }
        }
    }
    if (missing.empty()) {
        return;
    }
    result.status = ExpectationResult::Status::failed;
    result.detail = fmt::format("cannot be judged: {} went with it",
                                join(std::vector<std::string>{missing.begin(), missing.end()}, ", "));
    if (result.value) {
        result.detail += fmt::format(" (by what is left: {:.6g})", *result.value);
        result.value.reset();
    }
}

} // namespace gridspace::launcher
