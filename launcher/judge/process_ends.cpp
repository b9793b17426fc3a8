// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/process_ends.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace gridspace::launcher {

/// "relay1 restarted", "relay1 killed"
std::vector<ProcessEnd> ends_of(std::string const& process, std::vector<LoggedEvent> const& events) {
    std::vector<ProcessEnd> out;
    for (LoggedEvent const& event : events) {
        bool const again = event.text == process + " restarted";
        if (event.source == "launcher" && (again || event.text == process + " killed")) {
            out.push_back({std::llround(event.time_s * 1e9), again});
        }
    }
    return out;
}

Silences silences(SignalStore const& signals, std::map<std::string, std::set<std::string>> const& published,
                  std::vector<LoggedEvent> const& events) {
    Silences out;
    constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
    for (auto const& [process, names] : published) {
        std::vector<ProcessEnd> const ends = ends_of(process, events);
        for (std::size_t i = 0; i < ends.size(); ++i) {
            if (ends[i].again) {
                continue;
            }
            std::int64_t const back_ns = i + 1 < ends.size() ? ends[i + 1].time_ns : kNever;
            for (std::string const& name : names) {
                auto const it = signals.find(name);
                bool const shared = std::any_of(published.begin(), published.end(), [&](auto const& other) {
                    return other.first != process && other.second.contains(name);
                });
                if (shared || it == signals.end()) {
                    continue;
                }
                // What it said last may be about a time after its end: its latency lies between.
                std::vector<std::int64_t> const& times = it->second.times_ns;
                auto const next = std::lower_bound(times.begin(), times.end(), back_ns);
                std::int64_t const last_ns = next == times.begin() ? ends[i].time_ns : *std::prev(next);
                out[name].push_back({std::max(ends[i].time_ns, last_ns), next == times.end() ? kNever : *next});
            }
        }
    }
    return out;
}

} // namespace gridspace::launcher
