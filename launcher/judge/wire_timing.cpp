// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/wire_timing.hpp"

#include "common/config/fields.hpp"
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "common/nearest_rank.hpp"
#include "launcher/wire/steady_interval.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;

SignalSeries const* find(SignalStore const& signals, std::string const& name) {
    auto const it = signals.find(name);
    return it == signals.end() || it->second.values.empty() ? nullptr : &it->second;
}

std::vector<double> values_of(SignalStore const& signals, std::string const& name) {
    SignalSeries const* series = find(signals, name);
    return series == nullptr ? std::vector<double>{} : series->values;
}

std::size_t last_count(SignalStore const& signals, std::string const& name) {
    SignalSeries const* series = find(signals, name);
    return series == nullptr ? 0 : static_cast<std::size_t>(series->values.back());
}

/// Indices of the rows in which a signal leaves zero.
std::vector<std::size_t> rises(SignalSeries const* series) {
    std::vector<std::size_t> out;
    for (std::size_t i = 1; series != nullptr && i < series->values.size(); ++i) {
        if (series->values[i] != 0 && series->values[i - 1] == 0) {
            out.push_back(i);
        }
    }
    return out;
}

/// A number of a stream's entry in `streams:`; nothing where it has none.
std::optional<double> declared(Node const& scenario, std::string const& stream, char const* key) {
    Node const* streams = scenario.find("streams");
    Node const* entry = streams == nullptr ? nullptr : streams->find(stream);
    Node const* value = entry == nullptr ? nullptr : entry->find(key);
    return value == nullptr ? std::nullopt : config::number_of(*value);
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

SmvTiming smv_timing(SignalStore const& signals, Node const& scenario, std::string const& stream) {
    std::string const prefix = "stream." + stream + ".";
    SmvTiming out;
    out.stream = stream;
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
    if (SignalSeries const* ages = find(signals, prefix + "arrival_age_ms")) {
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

std::string gaps_of(CounterGaps const& gaps, std::string const& stream) {
    std::string out;
    if (auto const it = gaps.find("stream." + stream + ".lost"); it != gaps.end()) {
        for (CounterGap const& gap : it->second) {
            out += (out.empty() ? "" : ", ") + gap.to_string();
        }
    }
    return out;
}

GooseTiming goose_timing(SignalStore const& signals, std::string const& stream) {
    std::string const prefix = "stream." + stream + ".";
    GooseTiming out;
    out.stream = stream;
    SignalSeries const* intervals = find(signals, prefix + "interval_ms");
    SignalSeries const* states = find(signals, prefix + "st_num");
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

std::string declared_text(Node const& entry, char const* key) {
    Node const* value = entry.find(key);
    return value == nullptr || !value->is_scalar() ? std::string{} : value->text;
}

/// The captured streams of a declared one's name and APPID, that with most frames first. There may be an attacker's.
std::vector<wire::StreamStatistics const*> captured(Results const& r, Node const& entry) {
    std::vector<wire::StreamStatistics const*> out;
    bool const goose = declared_text(entry, "kind") == "goose";
    std::string const id = wire::visible(declared_text(entry, goose ? "control_block" : "sv_id"));
    std::string const app_id = declared_text(entry, "app_id");
    if (!r.capture) {
        return out;
    }
    for (wire::StreamStatistics const& s : r.capture->streams) {
        bool const same_app = app_id.empty() || std::stoul(app_id, nullptr, 0) == s.stream.app_id;
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

/// Counts and intervals of the capture; the sender's own publish_age where it is ours.
SmvTiming captured_smv(Results const& r, Node const& scenario, std::string const& name,
                       std::vector<wire::StreamStatistics const*> const& seen) {
    SmvTiming out = smv_timing(r.signals, scenario, name);
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

GooseTiming captured_goose(std::string const& name, wire::StreamStatistics const& seen) {
    GooseTiming out;
    out.stream = name;
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

/// The last event of the timeline before `until_s`; a fault rather than anything else.
std::optional<std::pair<std::string, double>> cause_before(Node const& scenario, double until_s) {
    std::optional<std::pair<std::string, double>> out;
    bool is_fault = false;
    Node const* events = scenario.find("events");
    for (Node::Entry const& event : events == nullptr ? std::vector<Node::Entry>{} : events->entries) {
        Node const* at = event.value.find("at_s");
        double const time_s = at == nullptr ? until_s + 1 : config::number_of(*at).value_or(until_s + 1);
        bool const fault = event.value.find("apply_fault") != nullptr;
        if (time_s <= until_s && (fault || !is_fault) && (!out || time_s >= out->second || (fault && !is_fault))) {
            out = {event.key, time_s};
            is_fault = fault;
        }
    }
    return out;
}

/// The lines at whose ends a relay's current transformers are, by the run's copy of the network file.
std::set<std::string> own_lines(Results const& r, Node const& scenario, ProtectionChain const& chain) {
    std::set<std::string> out;
    config::Diagnostics ignored; // the run was started with it
    auto network = config::load_yaml(r.folder / "network.yaml", ignored);
    if (!network || !network->is_map()) {
        return out;
    }
    Node const* simulation = scenario.find("simulation");
    if (Node const* changes = simulation == nullptr ? nullptr : simulation->find("network_changes");
        changes != nullptr && changes->is_map()) {
        config::merge(*network, *changes);
    }
    Node const* transformers = network->find("cts");
    for (ProtectionChain::End const& end : chain.ends) {
        Node const* ct = transformers == nullptr ? nullptr : transformers->find(end.transformer);
        if (Node const* line = ct == nullptr ? nullptr : ct->find("line"); line != nullptr && line->is_scalar()) {
            out.insert(line->text);
        }
    }
    return out;
}

/// The newest fault on one of the lines at `until_s`. One that cleared itself long before is no cause of a trip.
std::optional<std::pair<std::string, double>> fault_on(Node const& scenario, std::set<std::string> const& lines,
                                                       double until_s) {
    constexpr double kLongS = 0.1;
    std::optional<std::pair<std::string, double>> out;
    Node const* events = scenario.find("events");
    for (Node::Entry const& event : events == nullptr ? std::vector<Node::Entry>{} : events->entries) {
        auto const number = [&](char const* key) {
            Node const* node = event.value.find(key);
            return node == nullptr ? std::nullopt : config::number_of(*node);
        };
        Node const* fault = event.value.find("apply_fault");
        Node const* line = fault == nullptr ? nullptr : fault->find("line");
        auto const at = number("at_s");
        if (line == nullptr || !lines.contains(line->text) || !at || *at > until_s || (out && *at < out->second)) {
            continue;
        }
        auto const stands_ms = number("clear_after_ms");
        if (!stands_ms || *at + *stands_ms / 1e3 + kLongS >= until_s) {
            out = {event.key, *at};
        }
    }
    return out;
}

/// What a series holds at a time, or nothing where it has no row within a microsecond.
std::optional<double> at_instant(SignalSeries const* series, double time_s) {
    if (series == nullptr) {
        return std::nullopt;
    }
    auto const wanted = std::llround(time_s * 1e9);
    auto const it = std::lower_bound(series->times_ns.begin(), series->times_ns.end(), wanted - 1000);
    return it == series->times_ns.end() || *it > wanted + 1000
               ? std::nullopt
               : std::optional{series->values[static_cast<std::size_t>(it - series->times_ns.begin())]};
}

/// From the trip's arrival at the breaker IED to open poles. `state`: the stNum of the trip.
void add_effects(SignalStore const& signals, ProtectionChain const& chain, std::string const& clock,
                 std::optional<double> state, RelayTiming& out) {
    auto const add = [&](std::string what, double at_ms, bool communication, std::string method) {
        bool const simulated = !method.starts_with("wall clock");
        out.chain.push_back(
            {std::move(what), std::move(method), at_ms - out.event_s * 1e3, communication, {}, simulated});
    };
    SignalSeries const *heard = find(signals, "stream." + chain.trip_stream + ".heard_st_num"),
                       *heard_at = find(signals, "stream." + chain.trip_stream + ".heard_after_ms");
    for (std::size_t i = 0; state && heard != nullptr && heard_at != nullptr &&
                            i < std::min(heard->values.size(), heard_at->values.size());
         ++i) {
        if (heard->values[i] == *state) {
            add("trip GOOSE received", heard_at->values[i], !out.chain.empty(), // or nobody knows when it was sent
                clock + ": the receiving kernel's stamp at the breaker IED");
            break;
        }
    }
    for (ProtectionChain::BreakerIed const& ied : chain.ieds) {
        std::string const ied_prefix = "breaker_ied." + ied.process + ".";
        SignalSeries const *at = find(signals, ied_prefix + "commanded_after_ms"),
                           *effect = find(signals, ied_prefix + "effect_ms");
        std::optional<std::size_t> commanded;
        for (std::size_t const i : rises(find(signals, ied_prefix + "command"))) {
            if (!commanded && at != nullptr && i < at->values.size() && at->values[i] >= out.event_s * 1e3) {
                commanded = i;
            }
        }
        if (commanded && effect != nullptr && *commanded < effect->values.size()) {
            add(fmt::format("command of {} in DDS", ied.process), at->values[*commanded], false,
                clock + ": written to " + ied.topic);
            add("command takes effect", effect->values[*commanded], false,
                "simulated time stated in the command: its message plus the declared latency of the breaker IED");
        }
        for (std::string const& breaker : ied.breakers) {
            std::optional<double> last;
            for (char const phase : {'a', 'b', 'c'}) {
                SignalSeries const* pole = find(signals, fmt::format("breaker.{}.pole.{}", breaker, phase));
                for (std::size_t i = 0; pole != nullptr && i < pole->values.size(); ++i) {
                    constexpr double kOpenPosition = 1;
                    if (pole->values[i] == kOpenPosition &&
                        static_cast<double>(pole->times_ns[i]) / 1e9 >= out.event_s) {
                        last = std::max(last.value_or(0), static_cast<double>(pole->times_ns[i]) / 1e6);
                        break;
                    }
                }
            }
            if (last) {
                add(breaker + ": last pole open", *last, false,
                    "simulated time: each pole opens at its own current zero");
                out.chain.back().opens = true;
            }
        }
    }
    for (std::size_t i = 0; i < out.chain.size(); ++i) {
        // A decision is about a sample: its age is counted from the sample's instant. Otherwise the clocks do not mix.
        bool const about_sample = i == 1 && !out.foreign;
        std::size_t before = i == 0 ? 0 : i - 1;
        while (before > 0 && out.chain[i].opens && out.chain[before].opens) {
            --before;
        }
        if (i == 0 || about_sample || out.chain[i].simulated == out.chain[before].simulated) {
            out.chain[i].since_before_ms = out.chain[i].after_ms - (i == 0 ? 0 : out.chain[before].after_ms);
        }
    }
}

/// The chain behind a relay that is not ours: what its message did. Its inside is not measurable.
RelayTiming foreign_timing(Results const& r, Node const& scenario, ProtectionChain const& chain) {
    RelayTiming out;
    out.relay = chain.relay;
    out.foreign = true;
    std::optional<double> commanded_ms;
    for (ProtectionChain::BreakerIed const& ied : chain.ieds) {
        SignalSeries const* at = find(r.signals, "breaker_ied." + ied.process + ".commanded_after_ms");
        auto const up = rises(find(r.signals, "breaker_ied." + ied.process + ".command"));
        if (!up.empty() && at != nullptr && up.front() < at->values.size()) {
            commanded_ms = std::min(commanded_ms.value_or(at->values[up.front()]), at->values[up.front()]);
        }
    }
    auto const cause = commanded_ms ? cause_before(scenario, *commanded_ms / 1e3) : std::nullopt;
    if (!cause) {
        return out;
    }
    out.event = cause->first;
    out.event_s = cause->second;
    SignalSeries const *heard = find(r.signals, "stream." + chain.trip_stream + ".heard_st_num"),
                       *heard_at = find(r.signals, "stream." + chain.trip_stream + ".heard_after_ms");
    std::optional<double> state; // the newest that had come when the command was given
    for (std::size_t i = 0;
         heard != nullptr && heard_at != nullptr && i < std::min(heard->values.size(), heard_at->values.size()); ++i) {
        state = heard_at->values[i] <= *commanded_ms ? std::optional{heard->values[i]} : state;
    }
    add_effects(r.signals, chain, r.mode == "lockstep" ? "simulated time" : "wall clock since the start of the run",
                state, out);
    return out;
}

RelayTiming relay_timing(Results const& r, Node const& scenario, ProtectionChain const& chain) {
    SignalStore const& signals = r.signals;
    bool const lockstep = r.mode == "lockstep";
    std::string const prefix = "relay." + chain.relay + ".";
    RelayTiming out;
    out.relay = chain.relay;
    SignalSeries const* decisions = find(signals, prefix + "sample_to_decision_ms");
    out.transfer = spread_of(decisions == nullptr ? std::vector<double>{} : decisions->values);
    SignalSeries const* samples = find(signals, prefix + "sample_s");
    for (std::size_t const i : rises(find(signals, prefix + "trip"))) {
        if (samples != nullptr && i < samples->values.size()) {
            out.trips_s.push_back(samples->values[i]);
        }
    }
    if (out.trips_s.empty()) {
        return out;
    }
    std::size_t const tripped = rises(find(signals, prefix + "trip")).front();
    double const sample_s = out.trips_s.front();
    auto cause = fault_on(scenario, own_lines(r, scenario, chain), sample_s);
    out.own_line = cause.has_value();
    if (!cause) {
        cause = cause_before(scenario, sample_s);
    }
    if (!cause) {
        return out;
    }
    out.event = cause->first;
    out.event_s = cause->second;
    auto const add = [&](std::string what, double at_ms, bool communication, std::string method) {
        bool const simulated = !method.starts_with("wall clock");
        out.chain.push_back(
            {std::move(what), std::move(method), at_ms - out.event_s * 1e3, communication, {}, simulated});
    };
    double pickup_s = sample_s;
    for (std::size_t const i : rises(find(signals, prefix + "pickup"))) {
        pickup_s = i <= tripped && i < samples->values.size() ? samples->values[i] : pickup_s;
    }
    add("sample that picks up", pickup_s * 1e3, false,
        "simulated instant of the sample with which the element reached its pickup");
    std::string const clock = lockstep ? "simulated time" : "wall clock since the start of the run";
    auto const decided_ms =
        lockstep ? std::optional{static_cast<double>(samples->times_ns[tripped]) / 1e6}
                 : at_instant(decisions, sample_s).transform([&](double age) { return sample_s * 1e3 + age; });
    if (decided_ms) {
        add("relay decides to trip", *decided_ms, false, clock + ": the decision about the sample that trips");
    }
    SignalSeries const *states = find(signals, "stream." + chain.trip_stream + ".st_num"),
                       *sent = find(signals, "stream." + chain.trip_stream + ".sent_after_ms");
    constexpr double kRoundingMs = 1e-3;
    // Another member of the stream may have changed before: the trip is what was sent after the decision.
    double const earliest_ms = std::max(out.event_s, decided_ms.value_or(sample_s * 1e3) / 1e3) * 1e3 - kRoundingMs;
    std::optional<double> state;
    for (std::size_t i = 1;
         states != nullptr && sent != nullptr && i < std::min(states->values.size(), sent->values.size()) && !state;
         ++i) {
        if (states->values[i] != states->values[i - 1] && sent->values[i] >= earliest_ms) {
            state = states->values[i];
            add("trip GOOSE sent", sent->values[i], false,
                clock + ": handed to the kernel; the relay holds it back until its declared latency has passed");
        }
    }
    add_effects(signals, chain, clock, state, out);
    return out;
}

} // namespace

Spread spread_of(std::vector<double> values) {
    Spread out;
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    out.count = values.size();
    if (values.empty()) {
        return out;
    }
    std::sort(values.begin(), values.end());
    for (double const v : values) {
        out.mean += v / static_cast<double>(values.size());
    }
    constexpr double kNanosecondMs = 1e-6; // what the arithmetic of doubles may lose
    out.below_zero = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double v) { return v < -kNanosecondMs; }));
    out.min = values.front();
    out.p50 = nearest_rank(values, 0.5);
    out.p99 = nearest_rank(values, 0.99);
    out.p999 = nearest_rank(values, 0.999);
    out.max = values.back();
    return out;
}

WireTiming measure_wire_timing(Results const& r, Node const& scenario) {
    WireTiming out;
    out.lockstep = r.mode == "lockstep";
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        for (ProtectionChain::End const& end : chain.ends) {
            if (find(r.signals, "stream." + end.stream + ".received") != nullptr) {
                out.smv.push_back(smv_timing(r.signals, scenario, end.stream));
                out.smv.back().not_counted = gaps_of(r.counter_gaps, end.stream);
            }
        }
        if (auto goose = goose_timing(r.signals, chain.trip_stream); goose.messages > 0) {
            out.goose.push_back(std::move(goose));
        }
        out.relays.push_back(relay_timing(r, scenario, chain));
    }
    for (ProtectionChain const& chain : foreign_chains(scenario)) {
        out.relays.push_back(foreign_timing(r, scenario, chain));
    }
    for (std::string const& name : uncounted_streams(r, scenario)) {
        Node const& entry = *scenario.find("streams")->find(name);
        auto const seen = captured(r, entry);
        bool const goose = declared_text(entry, "kind") == "goose";
        if (seen.empty()) {
            out.not_seen.push_back(name);
        } else if (goose) {
            out.goose.push_back(captured_goose(name, *seen.front()));
        } else {
            out.smv.push_back(captured_smv(r, scenario, name, seen));
        }
    }
    return out;
}

std::vector<std::string> uncounted_streams(Results const& r, Node const& scenario) {
    std::vector<std::string> out;
    Node const* streams = scenario.find("streams");
    for (Node::Entry const& entry : streams == nullptr ? std::vector<Node::Entry>{} : streams->entries) {
        std::string const kind = declared_text(entry.value, "kind"), prefix = "stream." + entry.key + ".";
        bool const counted = find(r.signals, prefix + (kind == "goose" ? "interval_ms" : "received")) != nullptr &&
                             gaps_of(r.counter_gaps, entry.key).empty();
        if ((kind == "smv" || kind == "goose") && !counted) {
            out.push_back(entry.key);
        }
    }
    return out;
}

} // namespace gridspace::launcher
