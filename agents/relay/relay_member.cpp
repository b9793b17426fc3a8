// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_member.hpp"

#include "common/log.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::relay {

using gateways::WireClock;
using gateways::WirePort;

namespace {

std::string refusal_text(std::string const& stream, iec61850::SvSubscription const& subscription, iec61850::SvEvent why,
                         iec61850::Asdu const& asdu) {
    return why == iec61850::SvEvent::conf_rev_mismatch
               ? fmt::format("'{}' has confRev {}, and {} is subscribed to", stream, asdu.conf_rev,
                             subscription.conf_rev)
               : fmt::format("the samples of '{}' have {} octets, and {} are subscribed to", stream, asdu.sample.size(),
                             subscription.sample_octets);
}

} // namespace

RelayMember::RelayMember(RelaySettings const& settings, DaemonRun& run, bus::Node& node)
    : settings_{settings}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock},
      latency_ns_{
          clock_.lasting(node.time_base().ceil(settings.relay.latency_us / Rational{1'000'000}), settings.wire.speed)},
      promise_{node.time_base().nearest(node.config().clock.promise_s)} {}

Result<void> RelayMember::prepare() {
    auto parts = make_parts(settings_, run_, node_);
    if (!parts) {
        return std::unexpected{parts.error()};
    }
    parts_ = std::move(*parts);
    time_.emplace(node_, parts_.rate_hz, settings_.wire.speed);
    parts_.inputs->on_silence([this](std::size_t end) { silent(end); });
    parts_.inputs->on_refusal([this](std::size_t end, iec61850::SvEvent why, iec61850::Asdu const& asdu) {
        if (end < parts_.signals->streams()) { // one stream may be heard for both
            tell("stream_refused", refusal_text(settings_.relay.inputs()[end].name,
                                                parts_.inputs->end(end).subscriber.subscription(), why, asdu));
        }
    });
    if (parts_.first_line != nullptr) {
        parts_.inputs->on_finding([this](std::size_t end, std::uint32_t findings, iec61850::Mac const& source) {
            if (end < parts_.signals->streams()) { // one stream may be heard for both
                parts_.first_line->finding(end, findings, source, now());
            }
        });
    }
    return prepare_relay();
}

void RelayMember::begin(bus::Tick const& tick) {
    parts_.signals->announce(tick.time);
    announce(tick.time);
    if (parts_.first_line != nullptr) {
        parts_.first_line->announce(tick.time);
    }
    parts_.trip->announce(tick.time);
    now_ns_ = clock_.at_tick(tick.time);
    parts_.trip->start(now_ns_);
    publish_state(); // also when no sample ever comes
}

Result<void> RelayMember::work(bus::Tick const& tick) {
    if (clock_.simulated()) {
        work_through(tick.time);
    } else {
        work_now();
    }
    report(tick);
    parts_.port->maintain();
    return {};
}

std::uint64_t RelayMember::next_tick(bus::Tick const& tick) const {
    auto const deadline = parts_.inputs->deadline();
    auto const due = parts_.trip->due(); // sent ahead, as far as is promised
    std::uint64_t const of_trip = due ? grid_.tick_of(clock_.at_or_after(*due) - promise_) : bus::TickGrid::kNever;
    std::uint64_t const of_input = deadline ? grid_.tick_of(clock_.at_or_after(*deadline)) : bus::TickGrid::kNever;
    return deadline || due ? std::min(of_trip, of_input) : tick.number + 1;
}

std::optional<std::chrono::steady_clock::time_point> RelayMember::deadline() const {
    auto const work = next_work();
    return work ? std::optional{WireClock::wall(*work)} : std::nullopt;
}

std::optional<std::int64_t> RelayMember::next_work() const {
    auto out = parts_.trip->due();
    if (auto const deadline = parts_.inputs->deadline()) {
        out = out ? std::min(*out, *deadline) : *deadline;
    }
    return out;
}

/// Does everything that time alone asks for, up to and including `until_ns`, in its order.
void RelayMember::elapse(std::int64_t until_ns) {
    while (true) {
        auto const deadline = parts_.inputs->deadline();
        auto const due = parts_.trip->due();
        bool const input_first = deadline && (!due || *deadline < *due);
        auto const at = input_first ? deadline : due;
        if (!at || *at > until_ns) {
            return;
        }
        now_ns_ = std::max(now_ns_, clock_.on_grid(*at));
        if (clock_.simulated() && now_ns_ > until_ns) {
            return; // rounded up to the time grid, behind the end of the tick
        }
        if (input_first) { // in real time it lives by arrivals
            parts_.inputs->elapse(clock_.simulated() ? now_ns_ : *at, on_pair_);
        } else {
            parts_.trip->work(now_ns_);
        }
    }
}

/// Everything of a tick, in the order of simulated time.
void RelayMember::work_through(SimTime end) {
    // Who was paused finds frames of ticks that are over; what it does about them, it does now.
    now_ns_ = std::max(now_ns_, clock_.of(end - node_.time_base().nearest(node_.config().clock.tick_s)));
    for (bus::WireFrame const* frame : parts_.port->take(iec61850::kSvEthertype)) {
        std::int64_t const at = clock_.of(frame->time);
        elapse(at - 1); // at equal times the frame comes first
        now_ns_ = std::max(now_ns_, at);
        parts_.inputs->frame(WirePort::octets(*frame), now_ns_, on_pair_);
    }
    elapse(clock_.of(end));
    if (promise_.quanta > 0) {
        parts_.trip->send_ahead(clock_.of(end + promise_));
    }
}

/// Everything that has come by now.
void RelayMember::work_now() {
    if (time_->becomes_known()) {
        publish_state();
    }
    take_frames();
    std::int64_t const now_ns = clock_.now();
    if (auto const work = next_work(); work && *work <= now_ns) {
        parts_.port->drain(); // what has come by now counts before what has run out by now
        take_frames();
    }
    elapse(now_ns);
}

/// The inputs live by the arrivals of the frames: a stall of this process is no gap in a stream. What follows from
/// them happens now.
void RelayMember::take_frames() {
    for (bus::WireFrame const* frame : parts_.port->take(iec61850::kSvEthertype)) {
        now_ns_ = clock_.now();
        time_->came(frame->arrived_ns, now_ns_);
        std::array<std::uint64_t, 2> const before{samples_of(0), samples_of(1)};
        parts_.inputs->elapse(frame->arrived_ns - 1, on_pair_); // at equal times the frame comes first
        parts_.inputs->frame(WirePort::octets(*frame), frame->arrived_ns, on_pair_);
        for (std::size_t i = 0; i < parts_.signals->streams(); ++i) {
            if (samples_of(i) != before[i] && frame->kernel_ns != 0) {
                parts_.signals->arrived(i, parts_.inputs->end(i).subscriber.last_index(), frame->kernel_ns, *time_);
            }
        }
    }
}

std::uint64_t RelayMember::samples_of(std::size_t end) const {
    return parts_.inputs->end(end).subscriber.counters().samples;
}

/// Counters once per simulated second.
void RelayMember::report(bus::Tick const& tick) {
    if (!time_->is_known() || !parts_.signals->due(tick.time, tick.final)) {
        return;
    }
    parts_.signals->report_statistics(tick.time, *parts_.inputs, *parts_.trip, *parts_.port);
    if (parts_.first_line != nullptr) {
        parts_.first_line->report(tick.time);
    }
    if (!parts_.signals->report_counters(tick.time, tick.final, *parts_.inputs)) {
        return;
    }
    report_relay(tick);
    parts_.signals->flush();
}

void RelayMember::send(bool state, std::size_t field) {
    if (settings_.relay.trip_output == RelayConfig::TripOutput::enabled) {
        parts_.trip->set(state, now_ns_ + latency_ns_, field); // in real time at least so late: a hold-back
    }
}

void RelayMember::tell(std::string_view kind, std::string const& text) {
    log::info("{}: {}", kind, text);
    if (time_->is_known()) { // what was before is in the log; it is no event of the run
        run_.status.event(node_.time_base().seconds(now()), node_.config().process, kind, text);
    }
}

} // namespace gridspace::relay
