// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/live_judge.hpp"

#include "common/text.hpp"
#include "launcher/judge/counters.hpp"

#include <algorithm>

namespace gridspace::launcher {

LiveJudge::LiveJudge(JudgedRun run)
    : run_{std::move(run)}, recording_{run_.folder / "data.mcap"},
      signals_{
          [this](std::string const&, std::string const& signal) { return wanted(signal) ? Keep::all : Keep::none; }} {}

bool LiveJudge::wanted(std::string const& signal) const {
    if (!run_.lockstep && signal.starts_with("stream.")) { // delays are made of them
        return true;
    }
    return std::any_of(run_.expectations.begin(), run_.expectations.end(), [&](Expectation const& e) {
        std::vector<std::string> const& used = e.expression->signals();
        return (!e.stream.empty() && signal.starts_with(e.stream + ".")) ||
               std::any_of(used.begin(), used.end(),
                           [&](std::string const& pattern) { return matches_glob(pattern, signal); });
    });
}

void LiveJudge::read_on() {
    recording_.read_on([&](mcap::Message const& message) {
        std::string const& topic = message.channel.topic;
        if (topic == "simulation_clock" || topic == "clock_ack") {
            auto const time_ns = static_cast<std::int64_t>(message.time_ns) - run_.epoch_unix_s * 1'000'000'000;
            now_ns_ = std::max(now_ns_, time_ns);
        } else if (auto const process = message.channel.metadata.find("process");
                   topic == "signal_catalog" && process != message.channel.metadata.end()) {
            published_.publishes_catalog(process->second, message.data);
        }
        return signals_.take(topic, message.data);
    });
}

SignalStore LiveJudge::signals_until(std::int64_t until_ns) {
    SignalStore out;
    for (auto const& [name, series] : signals_.signals()) {
        auto const rows =
            std::upper_bound(series.times_ns.begin(), series.times_ns.end(), until_ns) - series.times_ns.begin();
        out[name] = {series.unit,
                     {series.times_ns.begin(), series.times_ns.begin() + rows},
                     {series.values.begin(), series.values.begin() + rows}};
    }
    if (!run_.lockstep) {
        derive_wire_delays(out);
    }
    return out;
}

std::optional<LiveJudge::Look> LiveJudge::look() {
    before_ns_ = now_ns_;
    read_on();
    std::int64_t const until_ns = before_ns_ - signals_.longest_frame_ns();
    if (until_ns <= judged_ns_) {
        return std::nullopt;
    }
    judged_ns_ = until_ns;
    Look out;
    out.reached_s = static_cast<double>(until_ns) / 1e9;
    SignalStore signals = signals_until(until_ns);
    std::vector<LoggedEvent> events = read_events(run_.folder / "events.ndjson");
    std::erase_if(events, [&](LoggedEvent const& event) { return event.time_s > out.reached_s; });
    Moments const moments = moments_of(&run_.timeline, events);
    CounterGaps const gaps = continue_counters(signals, published_.published(), events);
    for (Expectation const& e : run_.expectations) {
        ExpectationStanding found = stand(e, signals, moments, out.reached_s, run_.duration_s, run_.lockstep);
        if (found.standing == Standing::holds || found.standing == Standing::passed) {
            mind_gaps(e, gaps, found.result);
            if (found.result.status == ExpectationResult::Status::failed) {
                found.standing = Standing::failed; // what a gap took away does not come back
            }
        }
        out.standings.push_back(std::move(found));
    }
    return out;
}

} // namespace gridspace::launcher
