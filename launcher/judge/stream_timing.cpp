// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/stream_timing.hpp"

#include "launcher/judge/number_at.hpp"
#include "launcher/judge/signal_rows.hpp"
#include "launcher/wire/steady_interval.hpp"

#include <algorithm>
#include <numeric>

namespace gridspace::launcher {
namespace {

using config::Node;

std::size_t last_count(SignalStore const& signals, std::string const& name) {
    SignalSeries const* series = series_of(signals, name);
    return series == nullptr ? 0 : static_cast<std::size_t>(series->values.back());
}

/// A number of a stream's entry in `streams:`; nothing where it has none.
std::optional<double> declared(Node const& scenario, std::string const& stream, char const* key) {
    Node const* streams = scenario.find("streams");
    return number_at(streams == nullptr ? nullptr : streams->find(stream), key);
}

std::string declared_text(Node const& entry, char const* key) {
    Node const* value = entry.find(key);
    return value == nullptr || !value->is_scalar() ? std::string{} : value->text;
}

/// The slope of the straight line that fits the number of frames over their arrivals best (least squares): where the
/// first or the last was late, the time between the two would be no measure of their rate. 0: fewer than two instants.
double frames_per_ms(std::vector<double> const& arrival_ms) {
    auto const n = static_cast<double>(arrival_ms.size());
    double const middle_ms = std::accumulate(arrival_ms.begin(), arrival_ms.end(), 0.0) / n, middle = (n - 1) / 2;
    double both = 0, times = 0;
    for (std::size_t i = 0; i < arrival_ms.size(); ++i) {
        double const t = arrival_ms[i] - middle_ms;
        both += t * (static_cast<double>(i) - middle);
        times += t * t;
    }
    return times > 0 ? both / times : 0;
}

std::string gaps_of(CounterGaps const& gaps, std::string const& stream) {
    std::string out;
    if (auto const it = gaps.find("stream." + stream + ".lost"); it != gaps.end()) {
        for (CounterGap const& gap : it->second) {
            out += (out.empty() ? "" : ", ") + gap.to_string();
        }
    }
    return out;
}

/// The captured streams of a declared one's name and APPID, that with most frames first. There may be an attacker's.
std::vector<wire::StreamStatistics const*> captured(Results const& r, Node const& entry) {
    std::vector<wire::StreamStatistics const*> out;
    bool const goose = declared_text(entry, "kind") == "goose";
    std::string const id = wire::visible(declared_text(entry, goose ? "control_block" : "sv_id"));
    Node const* const app_id = entry.find("app_id");
    auto const wanted = app_id == nullptr ? std::nullopt : config::integer_of(*app_id);
    if (!r.capture) {
        return out;
    }
    for (wire::StreamStatistics const& s : r.capture->streams) {
        bool const same_app = app_id == nullptr || wanted == s.stream.app_id;
        if (s.stream.goose == goose && s.stream.id == id && same_app) {
            out.push_back(&s);
        }
    }
    std::stable_sort(out.begin(), out.end(), [](auto a, auto b) { return a->stream.frames > b->stream.frames; });
    return out;
}

Spread as_spread(wire::Percentiles const& p) {
    Spread out;
    out.count = p.count;
    out.min = p.min;
    out.mean = p.mean;
    out.p50 = p.p50;
    out.p99 = p.p99;
    out.p999 = p.p999;
    out.max = p.max;
    return out;
}

} // namespace

SmvTiming smv_timing(Results const& r, Node const& scenario, std::string const& stream) {
    SignalStore const& signals = r.signals;
    std::string const prefix = "stream." + stream + ".";
    SmvTiming out;
    out.stream = stream;
    out.not_counted = gaps_of(r.counter_gaps, stream);
    out.nominal_hz = declared(scenario, stream, "rate_hz");
    out.samples_per_frame =
        static_cast<std::size_t>(std::max(1.0, declared(scenario, stream, "samples_per_frame").value_or(1)));
    out.received = last_count(signals, prefix + "received");
    out.lost = last_count(signals, prefix + "lost");
    out.duplicate = last_count(signals, prefix + "duplicate");
    out.late = last_count(signals, prefix + "late");
    out.refused = last_count(signals, prefix + "invalid");
    out.publish_age = spread_of(values_of(signals, prefix + "publish_age_ms"));
    out.wire_delay = spread_of(values_of(signals, prefix + "wire_delay_ms"));
    if (SignalSeries const* ages = series_of(signals, prefix + "arrival_age_ms")) {
        std::vector<double> intervals;
        for (std::size_t i = 0; i < ages->values.size(); ++i) {
            out.sample_ns.push_back(ages->times_ns[i]);
            out.arrival_ms.push_back(static_cast<double>(ages->times_ns[i]) / 1e6 + ages->values[i]);
            if (i > 0) {
                intervals.push_back(out.arrival_ms[i] - out.arrival_ms[i - 1]);
            }
        }
        out.interval = spread_of(std::move(intervals));
        out.mean_hz = frames_per_ms(out.arrival_ms) * 1e3 * static_cast<double>(out.samples_per_frame);
    }
    return out;
}

GooseTiming goose_timing(SignalStore const& signals, std::string const& stream) {
    std::string const prefix = "stream." + stream + ".";
    GooseTiming out;
    out.stream = stream;
    SignalSeries const* intervals = series_of(signals, prefix + "interval_ms");
    SignalSeries const* states = series_of(signals, prefix + "st_num");
    if (intervals == nullptr || states == nullptr) {
        return out;
    }
    out.messages = intervals->values.size();
    out.interval_ms = intervals->values;
    for (std::size_t i = 1; i < states->values.size() && !out.event; ++i) {
        if (states->values[i] != states->values[i - 1]) {
            out.event = i;
        }
    }
    std::vector<wire::MessageInterval> messages;
    for (std::size_t i = 1; i < std::min(states->values.size(), out.interval_ms.size()); ++i) {
        messages.push_back({out.interval_ms[i], states->values[i] == states->values[i - 1]});
    }
    out.steady_ms = wire::steady_interval_ms(messages);
    out.wire_delay = spread_of(values_of(signals, prefix + "wire_delay_ms"));
    return out;
}

std::optional<SmvTiming> captured_smv(Results const& r, Node const& scenario, std::string const& stream) {
    auto const seen = captured(r, *scenario.find("streams")->find(stream));
    if (seen.empty()) {
        return std::nullopt;
    }
    SmvTiming out = smv_timing(r, scenario, stream);
    out.not_counted.clear();
    wire::ObservedStream const& c = seen.front()->stream;
    out.captured = true;
    out.other_senders = seen.size() - 1;
    out.received = c.counter->counters().samples;
    out.lost = c.lost;
    out.duplicate = c.duplicates;
    out.late = c.out_of_order;
    if (r.mode != "lockstep") {
        out.interval = as_spread(seen.front()->interval_ms);
        out.mean_hz = seen.front()->stream.rate_hz();
    }
    return out;
}

std::optional<GooseTiming> captured_goose(Results const& r, Node const& scenario, std::string const& stream) {
    auto const all = captured(r, *scenario.find("streams")->find(stream));
    if (all.empty()) {
        return std::nullopt;
    }
    wire::StreamStatistics const& seen = *all.front();
    GooseTiming out;
    out.stream = stream;
    out.captured = true;
    out.messages = seen.stream.frames;
    out.steady_ms = seen.steady_ms;
    out.interval_ms.push_back(0); // the first has none before it
    for (wire::MessageInterval const& interval : seen.stream.intervals) {
        if (!interval.same_state && !out.event) {
            out.event = out.interval_ms.size();
        }
        out.interval_ms.push_back(interval.ms);
    }
    return out;
}

std::vector<std::string> uncounted_streams(Results const& r, Node const& scenario) {
    std::vector<std::string> out;
    Node const* streams = scenario.find("streams");
    for (Node::Entry const& entry : streams == nullptr ? std::vector<Node::Entry>{} : streams->entries) {
        std::string const kind = declared_text(entry.value, "kind"), prefix = "stream." + entry.key + ".";
        bool const counted = series_of(r.signals, prefix + (kind == "goose" ? "interval_ms" : "received")) != nullptr &&
                             gaps_of(r.counter_gaps, entry.key).empty();
        if ((kind == "smv" || kind == "goose") && !counted) {
            out.push_back(entry.key);
        }
    }
    return out;
}

bool is_goose(Node const& scenario, std::string const& stream) {
    return declared_text(*scenario.find("streams")->find(stream), "kind") == "goose";
}

} // namespace gridspace::launcher
