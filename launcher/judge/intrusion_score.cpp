// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/intrusion_score.hpp"

#include "agents/relay/relay_program.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/judge/number_at.hpp"
#include "launcher/judge/run_network.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;
using Track = IntrusionRecording::Track;

/// A trip so long after a fault is still its trip.
constexpr double kTripWithinS = 0.5;
/// An alarm so long after a forged sample is its alarm: the detector waits for the other end before it says forgery.
constexpr double kAlarmWithinS = 0.005;

std::string text_of(Node const* node, std::string_view key) {
    Node const* value = node == nullptr ? nullptr : node->find(key);
    return value == nullptr ? "" : value->text;
}

void score_stream(IntrusionScore& out, Track const& track) {
    ids::Scorer scorer;
    std::map<std::int64_t, std::uint8_t> forged; ///< phases, by sample
    std::map<std::string, std::string> kinds;
    for (IntrusionRecording::Label const& l : out.recording.labels) {
        if (l.target == track.stream) {
            scorer.add(ids::ScoredLabel{l.attack, l.target, l.index, l.channel, l.true_value, l.sent_value});
            forged[l.index] = static_cast<std::uint8_t>(forged[l.index] | (1U << l.channel));
            kinds[l.attack] = l.kind;
        }
    }
    std::uint64_t healthy = 0, flagged = 0, open_flagged = 0;
    for (IntrusionRecording::Sample const& s : track.samples) {
        bool judged = false, any = false, any_open = false;
        for (std::uint8_t p = 0; p < 3; ++p) {
            IntrusionRecording::Phase const& v = s.phases[p];
            if (v.judged) {
                scorer.add(ids::ScoredVerdict{track.stream, s.index, p, v.raw_a, v.forecast_a, v.accepted_a, v.limit_a,
                                              v.flagged, v.open_flagged});
            }
            judged = judged || v.judged;
            any = any || v.flagged;
            any_open = any_open || v.open_flagged;
        }
        if (judged && !forged.contains(s.index)) {
            ++healthy;
            flagged += any ? 1U : 0U;
            open_flagged += any_open ? 1U : 0U;
        }
    }
    IntrusionScore::Stream stream{track.detector, track.stream, scorer.score(), ids::share_of(flagged, healthy),
                                  ids::share_of(open_flagged, healthy)};
    for (ids::AttackScore const& attack : stream.score.attacks) {
        out.attacks.push_back({track.detector, kinds[attack.attack], track.stream, track.rate_hz, attack});
    }
    out.streams.push_back(std::move(stream));
}

void find_unjudged(IntrusionScore& out) {
    std::map<std::string, IntrusionScore::Unjudged> attacks;
    for (IntrusionRecording::Label const& l : out.recording.labels) {
        bool const watched = std::any_of(out.recording.tracks.begin(), out.recording.tracks.end(),
                                         [&](Track const& t) { return t.stream == l.target; });
        if (!watched) {
            IntrusionScore::Unjudged& u = attacks[l.attack];
            u.attack = l.attack;
            u.kind = l.kind;
            u.target = l.target;
            ++u.labels;
        }
    }
    for (auto& [name, u] : attacks) {
        out.unjudged.push_back(std::move(u));
    }
}

/// The transformer behind a stream: stream <- merging unit <- topic <- transformer.
std::string transformer_of(Node const& scenario, std::string const& stream) {
    std::string topic;
    if (Node const* processes = scenario.find("processes")) {
        for (Node::Entry const& p : processes->entries) {
            if (text_of(&p.value, "program") == "gridspace-mu" && text_of(&p.value, "to") == stream) {
                topic = text_of(&p.value, "from");
            }
        }
    }
    Node const* simulation = scenario.find("simulation");
    Node const* gateways = simulation == nullptr ? nullptr : simulation->find("gateways");
    if (gateways == nullptr || !gateways->is_map()) {
        return {};
    }
    for (Node::Entry const& g : gateways->entries) {
        if (std::string const ct = text_of(g.value.find("publish"), topic); !ct.empty()) {
            return ct;
        }
    }
    return {};
}

/// Faults of the timeline on a line.
std::vector<double> faults_on(Node const& scenario, std::string const& line) {
    std::vector<double> out;
    Node const* events = scenario.find("events");
    if (events == nullptr || line.empty()) {
        return out;
    }
    for (Node::Entry const& e : events->entries) {
        Node const* at = e.value.find("at_s");
        if (at != nullptr && text_of(e.value.find("apply_fault"), "line") == line) {
            out.push_back(config::number_of(*at).value_or(0));
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

/// Trips as the relay reported them, as sample indices. It counts samples from a second of its own in real time.
std::vector<std::int64_t> trips_of(std::string const& relay, std::vector<LoggedEvent> const& events, double rate_hz) {
    std::vector<std::int64_t> out;
    for (LoggedEvent const& e : events) {
        if (e.source == relay && e.event == "trip" && e.text.starts_with("sample ")) {
            double const sample = std::strtod(e.text.c_str() + 7, nullptr);
            double const second = std::round(e.time_s - sample / rate_hz);
            out.push_back(std::llround(sample + second * rate_hz));
        }
    }
    return out;
}

/// What the same relay decides without a detector, on the samples as they were received.
std::vector<std::int64_t> trips_on_raw(Track const& from, Track const& to, relay::RelayParams params) {
    params.seal_in = false; // each decision counts, not only the first
    relay::LineRelay relay{params};
    std::vector<std::int64_t> out;
    bool tripped = false;
    auto const present = [](IntrusionRecording::Sample const& s) {
        return s.phases[0].judged || s.phases[0].limit_a > 0;
    };
    auto t = to.samples.begin();
    for (IntrusionRecording::Sample const& f : from.samples) {
        while (t != to.samples.end() && t->index < f.index) {
            ++t;
        }
        if (t == to.samples.end() || t->index != f.index) {
            continue;
        }
        relay::LineSample sample{f.index, {}, {}};
        sample.from.present = present(f);
        sample.to.present = present(*t);
        for (std::size_t p = 0; p < 3; ++p) {
            sample.from.i_a[p] = f.phases[p].raw_a;
            sample.to.i_a[p] = t->phases[p].raw_a;
        }
        bool const now = relay.step(sample).trip;
        if (now && !tripped) {
            out.push_back(f.index);
        }
        tripped = now;
    }
    return out;
}

std::optional<relay::RelayParams> params_of(Node const& process, ScoredNetwork const& network, std::string const& to_ct,
                                            double rate_hz) {
    Node own = Node::map();
    for (Node::Entry const& entry : process.entries) {
        if (entry.key != "ids") {
            own.entries.push_back(entry);
        }
    }
    relay::RelayConfig config;
    config::Diagnostics ignored; // it has run with them; keys that are not the program's are the launcher's
    config::read_fields(own, "", ignored, [&](config::Fields& f) { describe(f, config); });
    double const frequency_hz = number_at(&own, "frequency_hz").value_or(network.frequency_hz);
    auto const whole = [](double v) { return Rational::parse(shortest(v)).value_or(Rational{60}); };
    auto params = relay::make_params(config.logic, whole(rate_hz), whole(frequency_hz));
    if (!params) {
        return std::nullopt;
    }
    params->to_positive = config.to_positive;
    Node const* cts = network.file.find("cts");
    if (own.find("positive") == nullptr && cts != nullptr && text_of(cts->find(to_ct), "positive") == "into_line") {
        params->to_positive = relay::Positive::into_line;
    }
    return *params;
}

/// Alarms of a relay's detector, and those for which there is no reason.
void count_alarms(IntrusionScore::Relay& r, IntrusionRecording const& recording, SignalStore const& signals) {
    auto const alarm = signals.find("ids." + r.relay + ".alarm");
    if (alarm == signals.end()) {
        return;
    }
    std::set<double> forged_s;
    for (IntrusionRecording::Label const& l : recording.labels) {
        if (l.target == r.from_stream || l.target == r.to_stream) {
            forged_s.insert(static_cast<double>(l.index) / r.rate_hz);
        }
    }
    bool before = false;
    for (std::size_t i = 0; i < alarm->second.values.size(); ++i) {
        bool const now = alarm->second.values[i] != 0;
        if (now && !before) {
            double const t = static_cast<double>(alarm->second.times_ns[i]) / 1e9;
            auto const next = forged_s.upper_bound(t);
            ++r.alarms;
            r.false_alarms += next == forged_s.begin() || t - *std::prev(next) > kAlarmWithinS ? 1U : 0U;
        }
        before = now;
    }
}

void score_relay(IntrusionScore& out, Node::Entry const& process, Node const& scenario, ScoredNetwork const& network,
                 SignalStore const& signals, std::vector<LoggedEvent> const& events, double end_s) {
    IntrusionScore::Relay r;
    r.relay = process.key;
    r.watched = process.value.find("ids") != nullptr;
    Node const* currents = process.value.find("currents");
    r.from_stream = text_of(currents, "from");
    r.to_stream = text_of(currents, "to");
    Track const* from = out.recording.find(r.relay, r.from_stream);
    Track const* to = out.recording.find(r.relay, r.to_stream);
    std::string const from_ct = transformer_of(scenario, r.from_stream), to_ct = transformer_of(scenario, r.to_stream);
    Node const* cts = network.file.find("cts");
    r.line = cts == nullptr ? "" : text_of(cts->find(from_ct), "line");
    r.faults_s = faults_on(scenario, r.line);
    r.rate_hz = from == nullptr ? 4800 : from->rate_hz;
    count_alarms(r, out.recording, signals);
    std::vector<ids::RealFault> faults;
    for (double const at : r.faults_s) {
        double const until = std::min(end_s, at + kTripWithinS);
        faults.push_back({std::llround(at * r.rate_hz), std::llround(until * r.rate_hz) + 1});
    }
    r.trips = trips_of(r.relay, events, r.rate_hz);
    for (LoggedEvent const& e : events) {
        if (e.source == r.relay && e.event == "trip") {
            r.trips_s.push_back(e.time_s);
        }
    }
    r.with = ids::score_trips(faults, r.trips);
    auto const params = params_of(process.value, network, to_ct, r.rate_hz);
    if (from != nullptr && to != nullptr && params) {
        r.trips_without = trips_on_raw(*from, *to, *params);
        r.without = ids::score_trips(faults, r.trips_without);
        for (ids::RealFault const& fault : faults) {
            auto const first = [&](std::vector<std::int64_t> const& trips) {
                return std::find_if(trips.begin(), trips.end(),
                                    [&](std::int64_t t) { return t >= fault.from && t < fault.until; });
            };
            auto const with = first(r.trips), without = first(r.trips_without);
            if (with != r.trips.end() && without != r.trips_without.end()) {
                r.added_each_ms.push_back(static_cast<double>(*with - *without) / r.rate_hz * 1e3);
                r.added_ms = std::max(r.added_ms.value_or(-1e9), r.added_each_ms.back());
            }
        }
    }
    out.relays.push_back(std::move(r));
}

} // namespace

IntrusionScore score_intrusion(IntrusionRecording recording, Node const& scenario, ScoredNetwork const& network,
                               SignalStore const& signals, std::vector<LoggedEvent> const& events, double end_s) {
    IntrusionScore out;
    out.recording = std::move(recording);
    for (Track const& track : out.recording.tracks) {
        score_stream(out, track);
    }
    find_unjudged(out);
    if (Node const* processes = scenario.find("processes")) {
        for (Node::Entry const& p : processes->entries) {
            if (text_of(&p.value, "program") == "gridspace-relay" && p.value.find("currents") != nullptr) {
                score_relay(out, p, scenario, network, signals, events, end_s);
            }
        }
    }
    return out;
}

void add_intrusion_signals(IntrusionScore const& score, double end_s, SignalStore& signals) {
    auto const add = [&](std::string const& name, std::string const& unit, double value) {
        signals[name] = {unit, {std::llround(end_s * 1e9)}, {value}};
    };
    for (IntrusionScore::Stream const& s : score.streams) {
        std::string const prefix = "ids." + s.detector + "." + s.stream + ".";
        add(prefix + "false_positive_percent", "%", s.score.false_positive.percent);
        add(prefix + "open_loop_false_positive_percent", "%", s.score.open_false_positive.percent);
    }
    std::map<std::string, IntrusionScore::Attack const*> worst; // several detectors: the one that saw least
    for (IntrusionScore::Attack const& a : score.attacks) {
        auto const [at, is_new] = worst.try_emplace(a.score.attack, &a);
        at->second =
            is_new || a.score.open_detected.percent >= at->second->score.open_detected.percent ? at->second : &a;
    }
    for (auto const& [name, a] : worst) {
        std::string const prefix = "score." + name + ".";
        add(prefix + "labels", "", static_cast<double>(a->score.labels));
        add(prefix + "judged", "", static_cast<double>(a->score.judged));
        add(prefix + "detected_percent", "%", a->score.open_detected.percent);
        add(prefix + "clear_detected_percent", "%", a->score.open_clear_detected.percent);
        add(prefix + "closed_loop_detected_percent", "%", a->score.detected.percent);
        add(prefix + "seen", "", a->score.seen ? 1 : 0);
        if (a->score.seen) {
            add(prefix + "delay_ms", "ms", static_cast<double>(a->score.delay_samples) / a->rate_hz * 1e3);
        }
    }
    for (IntrusionScore::Relay const& r : score.relays) {
        if (!r.watched) {
            continue;
        }
        std::string const prefix = "ids." + r.relay + ".";
        add(prefix + "false_trips", "", static_cast<double>(r.with.false_trips));
        add(prefix + "false_trips_without", "", static_cast<double>(r.without.false_trips));
        add(prefix + "real_faults", "", static_cast<double>(r.with.real_faults));
        add(prefix + "real_faults_tripped", "", static_cast<double>(r.with.tripped));
        add(prefix + "false_alarms", "", static_cast<double>(r.false_alarms));
        if (r.added_ms) {
            add(prefix + "real_fault_trip_added_ms", "ms", *r.added_ms);
        }
    }
}

Result<IntrusionScore> read_intrusion_score(std::filesystem::path const& folder, SignalStore const& signals,
                                            std::vector<LoggedEvent> const& events, double end_s) {
    auto recording = read_intrusion_recording(folder / "data.mcap");
    if (!recording) {
        return std::unexpected{recording.error()};
    }
    config::Diagnostics ignored;
    auto const scenario = config::load_yaml(folder / "scenario.resolved.yaml", ignored);
    Node const known = scenario ? *scenario : Node::map();
    return score_intrusion(std::move(*recording), known, {network_of_run(folder, known), frequency_of_run(folder)},
                           signals, events, end_s);
}

} // namespace gridspace::launcher
