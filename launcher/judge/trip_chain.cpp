// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/trip_chain.hpp"

#include "launcher/judge/causes.hpp"
#include "launcher/judge/signal_rows.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Node;

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

void add_step(RelayTiming& out, std::string what, double at_ms, bool communication, std::string method) {
    bool const simulated = !method.starts_with("wall clock");
    out.chain.push_back({std::move(what), std::move(method), at_ms - out.event_s * 1e3, communication, {}, simulated});
}

/// After the decision at `earliest_ms`. Returns the stNum of the trip, if it was sent.
std::optional<double> add_sending(SignalStore const& signals, ProtectionChain const& chain, std::string const& clock,
                                  double earliest_ms, RelayTiming& out) {
    SignalSeries const *states = series_of(signals, "stream." + chain.trip_stream + ".st_num"),
                       *sent = series_of(signals, "stream." + chain.trip_stream + ".sent_after_ms");
    for (std::size_t i = 1;
         states != nullptr && sent != nullptr && i < std::min(states->values.size(), sent->values.size()); ++i) {
        if (states->values[i] != states->values[i - 1] && sent->values[i] >= earliest_ms) {
            add_step(out, "trip GOOSE sent", sent->values[i], false,
                     clock + ": handed to the kernel; the relay holds it back until its declared latency has passed");
            return states->values[i];
        }
    }
    return std::nullopt;
}

/// `state`: the stNum of the trip.
void add_arrival(SignalStore const& signals, ProtectionChain const& chain, std::string const& clock,
                 std::optional<double> state, RelayTiming& out) {
    SignalSeries const *heard = series_of(signals, "stream." + chain.trip_stream + ".heard_st_num"),
                       *heard_at = series_of(signals, "stream." + chain.trip_stream + ".heard_after_ms");
    for (std::size_t i = 0; state && heard != nullptr && heard_at != nullptr &&
                            i < std::min(heard->values.size(), heard_at->values.size());
         ++i) {
        if (heard->values[i] == *state) {
            add_step(out, "trip GOOSE received", heard_at->values[i],
                     !out.chain.empty(), // or nobody knows when it was sent
                     clock + ": the receiving kernel's stamp at the breaker IED");
            break;
        }
    }
}

void add_command(SignalStore const& signals, ProtectionChain::BreakerIed const& ied, std::string const& clock,
                 RelayTiming& out) {
    std::string const prefix = "breaker_ied." + ied.process + ".";
    SignalSeries const *at = series_of(signals, prefix + "commanded_after_ms"),
                       *effect = series_of(signals, prefix + "effect_ms");
    std::optional<std::size_t> commanded;
    for (std::size_t const i : rises(series_of(signals, prefix + "command"))) {
        if (!commanded && at != nullptr && i < at->values.size() && at->values[i] >= out.event_s * 1e3) {
            commanded = i;
        }
    }
    if (commanded && effect != nullptr && *commanded < effect->values.size()) {
        add_step(out, fmt::format("command of {} in DDS", ied.process), at->values[*commanded], false,
                 clock + ": written to " + ied.topic);
        add_step(out, "command takes effect", effect->values[*commanded], false,
                 "simulated time stated in the command: its message plus the declared latency of the breaker IED");
    }
}

void add_opening(SignalStore const& signals, std::string const& breaker, RelayTiming& out) {
    std::optional<double> last;
    for (char const phase : {'a', 'b', 'c'}) {
        SignalSeries const* pole = series_of(signals, fmt::format("breaker.{}.pole.{}", breaker, phase));
        for (std::size_t i = 0; pole != nullptr && i < pole->values.size(); ++i) {
            if (pole->values[i] == kOpenPosition && static_cast<double>(pole->times_ns[i]) / 1e9 >= out.event_s) {
                last = std::max(last.value_or(0), static_cast<double>(pole->times_ns[i]) / 1e6);
                break;
            }
        }
    }
    if (last) {
        add_step(out, breaker + ": last pole open", *last, false,
                 "simulated time: each pole opens at its own current zero");
        out.chain.back().opens = true;
    }
}

/// How long each step took.
void count_from_step_to_step(RelayTiming& out) {
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

/// From the trip's arrival at the breaker IED to open poles. `state`: the stNum of the trip.
void add_effects(SignalStore const& signals, ProtectionChain const& chain, std::string const& clock,
                 std::optional<double> state, RelayTiming& out) {
    add_arrival(signals, chain, clock, state, out);
    for (ProtectionChain::BreakerIed const& ied : chain.ieds) {
        add_command(signals, ied, clock, out);
        for (std::string const& breaker : ied.breakers) {
            add_opening(signals, breaker, out);
        }
    }
    count_from_step_to_step(out);
}

} // namespace

RelayTiming relay_timing(Results const& r, Node const& scenario, ProtectionChain const& chain) {
    SignalStore const& signals = r.signals;
    bool const lockstep = r.mode == "lockstep";
    std::string const prefix = "relay." + chain.relay + ".";
    RelayTiming out;
    out.relay = chain.relay;
    SignalSeries const* decisions = series_of(signals, prefix + "sample_to_decision_ms");
    out.transfer = spread_of(decisions == nullptr ? std::vector<double>{} : decisions->values);
    SignalSeries const* samples = series_of(signals, prefix + "sample_s");
    for (std::size_t const i : rises(series_of(signals, prefix + "trip"))) {
        if (samples != nullptr && i < samples->values.size()) {
            out.trips_s.push_back(samples->values[i]);
        }
    }
    if (out.trips_s.empty()) {
        return out;
    }
    std::size_t const tripped = rises(series_of(signals, prefix + "trip")).front();
    double const sample_s = out.trips_s.front();
    auto cause = fault_on_own_line(r.folder, scenario, chain, sample_s);
    out.own_line = cause.has_value();
    if (!cause) {
        cause = cause_before(scenario, sample_s);
    }
    if (!cause) {
        return out;
    }
    out.event = cause->first;
    out.event_s = cause->second;
    double pickup_s = sample_s;
    for (std::size_t const i : rises(series_of(signals, prefix + "pickup"))) {
        pickup_s = i <= tripped && i < samples->values.size() ? samples->values[i] : pickup_s;
    }
    add_step(out, "sample that picks up", pickup_s * 1e3, false,
             "simulated instant of the sample with which the element reached its pickup");
    std::string const clock = lockstep ? "simulated time" : "wall clock since the start of the run";
    auto const decided_ms =
        lockstep ? std::optional{static_cast<double>(samples->times_ns[tripped]) / 1e6}
                 : at_instant(decisions, sample_s).transform([&](double age) { return sample_s * 1e3 + age; });
    if (decided_ms) {
        add_step(out, "relay decides to trip", *decided_ms, false,
                 clock + ": the decision about the sample that trips");
    }
    constexpr double kRoundingMs = 1e-3;
    // Another member of the stream may have changed before: the trip is what was sent after the decision.
    double const earliest_ms = std::max(out.event_s, decided_ms.value_or(sample_s * 1e3) / 1e3) * 1e3 - kRoundingMs;
    auto const state = add_sending(signals, chain, clock, earliest_ms, out);
    add_effects(signals, chain, clock, state, out);
    return out;
}

RelayTiming foreign_timing(Results const& r, Node const& scenario, ProtectionChain const& chain) {
    RelayTiming out;
    out.relay = chain.relay;
    out.foreign = true;
    std::optional<double> commanded_ms;
    for (ProtectionChain::BreakerIed const& ied : chain.ieds) {
        SignalSeries const* at = series_of(r.signals, "breaker_ied." + ied.process + ".commanded_after_ms");
        auto const up = rises(series_of(r.signals, "breaker_ied." + ied.process + ".command"));
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
    SignalSeries const *heard = series_of(r.signals, "stream." + chain.trip_stream + ".heard_st_num"),
                       *heard_at = series_of(r.signals, "stream." + chain.trip_stream + ".heard_after_ms");
    std::optional<double> state; // the newest that had come when the command was given
    for (std::size_t i = 0;
         heard != nullptr && heard_at != nullptr && i < std::min(heard->values.size(), heard_at->values.size()); ++i) {
        state = heard_at->values[i] <= *commanded_ms ? std::optional{heard->values[i]} : state;
    }
    add_effects(r.signals, chain, r.mode == "lockstep" ? "simulated time" : "wall clock since the start of the run",
                state, out);
    return out;
}

} // namespace gridspace::launcher
