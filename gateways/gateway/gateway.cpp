// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A gateway at work; gateway_setup.cpp opens what it works with.
#include "gateways/gateway/gateway_inputs.hpp"

#include "bus/topics.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::gateways {

Gateway::Gateway(GatewaySettings const& settings, DaemonRun& run, bus::Node& node, GatewayGuest* guest)
    : settings_{settings}, run_{run}, node_{node}, guest_{guest}, grid_{node.config().clock}, clock_{node} {}
Gateway::~Gateway() = default;

Result<void> Gateway::work(bus::Tick const& tick) {
    follow_start();
    tick_begin_ns_ = clock_.simulated() ? begin_ns(tick) : 0;
    take_input(tick);
    last_ = moment_of(tick);
    if (auto const due = next_timer(); due && *due <= last_.ns && !clock_.simulated()) {
        port_->drain(); // what has come by now counts before what has run out by now
        take_input(tick);
    }
    run_timers(last_.ns);
    if (tick.final) {
        finish(last_);
    }
    if (follower_ != nullptr) {
        follower_->work(last_.ns, last_.time);
    }
    publish_counters(tick);
    publish_ages();
    port_->maintain();
    return {};
}

std::optional<std::chrono::steady_clock::time_point> Gateway::deadline() const {
    std::int64_t const asks = follower_ != nullptr ? follower_->deadline() : INT64_MAX;
    return WireClock::wall(std::min({next_timer().value_or(INT64_MAX), asks, clock_.now() + 1'000'000'000}));
}

std::uint64_t Gateway::next_tick(bus::Tick const& tick) const {
    if (!topics_.empty()) {
        return tick.number + 1; // the simulator's samples do not wake anybody
    }
    auto const second = static_cast<std::int64_t>(node_.time_base().seconds(tick.time));
    std::uint64_t const report = grid_.tick_of(SimTime{} + node_.time_base().nearest(Rational{second + 1}));
    auto const timer = next_timer();
    return timer ? std::min(report, grid_.tick_of(clock_.at_or_after(*timer))) : report;
}

void Gateway::end(bus::Tick const&) {
    finish(last_);
}

void Gateway::finish(Moment at) {
    for (auto const& sink : sinks_) {
        if (!finished_) {
            sink->finish(at);
        }
    }
    finished_ = true;
}

Moment Gateway::moment_of(bus::Tick const& tick) const {
    return {clock_.at_tick(tick.time), tick.time};
}

/// Lockstep: the first instant that belongs to it. Timers are not bound to quanta.
std::int64_t Gateway::begin_ns(bus::Tick const& tick) const {
    return tick.number == 0 ? 0 : clock_.of(grid_.end_of(tick.number - 1)) + 1;
}

/// Real time: who paces its samples has to know when simulated time 0 was, as soon as somebody does.
void Gateway::follow_start() {
    if (auto const zero = clock_.known_start_unix_ns(); pacer_ != nullptr && zero) {
        pacer_->start(*zero);
    }
}

void Gateway::begin(bus::Tick const& tick) {
    follow_start();
    if (counters_ != nullptr) {
        counters_->announce(tick.time);
    }
    for (Sampled const& sampled : sampled_) {
        if (sampled.ages != nullptr) {
            sampled.ages->announce(tick.time);
        }
    }
    for (auto const& watch : watches_) {
        if (watch != nullptr) {
            watch->signals->announce(tick.time);
        }
    }
    for (auto const& subscription : subscriptions_) {
        subscription->announce(tick.time);
    }
    if (first_line_ != nullptr) {
        first_line_->announce(tick.time);
    }
    if (follower_ != nullptr) {
        follower_->announce(tick.time);
    }
    if (guest_ != nullptr) {
        guest_->announce(tick.time);
    }
    for (auto const& sink : sinks_) {
        sink->start(moment_of(tick));
    }
}

void Gateway::take_input(bus::Tick const& tick) {
    events_.clear();
    for (auto const& topic : topics_) {
        topic->due = topic->reader->take();
        for (std::size_t i = 0; i < topic->due.size(); ++i) {
            events_.push_back({topic->due[i].origin.time, topic.get(), i, nullptr, 0});
        }
    }
    for (std::uint16_t const ethertype : received_) {
        for (bus::WireFrame const* frame : port_->take(ethertype)) {
            events_.push_back({frame->time, nullptr, 0, frame, ethertype});
        }
    }
    if (!node_.lockstep()) { // as they came
        for (Event const& event : events_) {
            Moment at{clock_.now(), event.topic != nullptr ? event.time : tick.time};
            if (event.frame != nullptr) {
                at.kernel_ns = event.frame->kernel_ns;
                at.arrived_ns = event.frame->arrived_ns;
            }
            handle(event, at);
        }
        return;
    }
    std::stable_sort(events_.begin(), events_.end(), [](Event const& a, Event const& b) { return a.time < b.time; });
    for (Event const& event : events_) {
        Moment const at{clock_.of(event.time), event.time};
        run_timers(at.ns - 1); // at one instant, what arrives comes before what is due
        handle(event, at);
    }
}

void Gateway::handle(Event const& event, Moment at) {
    if (event.topic != nullptr) {
        for (Source* source : event.topic->sources) {
            source->receive(at, event.topic->due[event.sample].value.cdr);
        }
        return;
    }
    handle(*event.frame, event.ethertype, at);
}

void Gateway::handle(bus::WireFrame const& frame, std::uint16_t ethertype, Moment at) {
    bool const sampled = ethertype == iec61850::kSvEthertype;
    auto const decoded = sampled ? iec61850::decode_sv(WirePort::octets(frame), *sv_)
                                 : iec61850::decode_goose(WirePort::octets(frame), goose_);
    if (!decoded) {
        if (undecodable_++ == 0) {
            log::warning("a frame cannot be decoded (octet {}): {} (more of them are only counted)",
                         decoded.error().offset, iec61850::reason_name(decoded.error().reason));
        }
        return;
    }
    for (auto const& source : sources_) {
        if (sampled) {
            source->receive(at, *sv_);
        } else {
            source->receive(at, goose_);
        }
    }
    for (auto const& subscription : subscriptions_) {
        if (sampled) {
            subscription->receive(at, *sv_);
        } else {
            subscription->receive(at, goose_);
        }
    }
}

std::optional<std::int64_t> Gateway::next_timer() const {
    std::optional<std::int64_t> next;
    auto const consider = [&](std::optional<std::int64_t> due) { next = due && (!next || *due < *next) ? due : next; };
    for (auto const& sink : sinks_) {
        consider(sink->due());
    }
    for (auto const& source : sources_) {
        consider(source->deadline());
    }
    for (auto const& subscription : subscriptions_) {
        consider(subscription->deadline());
    }
    return next;
}

void Gateway::run_timers(std::int64_t until_ns) {
    for (auto next = next_timer(); next && *next <= until_ns; next = next_timer()) {
        // Who was paused finds what ticks that are over asked for; it does that now.
        std::int64_t const now = clock_.simulated() ? std::max(*next, tick_begin_ns_) : until_ns;
        Moment const at{now, clock_.sim_time(now)};
        for (auto const& source : sources_) {
            if (auto const deadline = source->deadline(); deadline && *deadline <= now) {
                source->expire(at);
            }
        }
        for (auto const& subscription : subscriptions_) {
            if (auto const deadline = subscription->deadline(); deadline && *deadline <= now) {
                subscription->expire(at);
            }
        }
        for (auto const& sink : sinks_) {
            if (auto const due = sink->due(); due && *due <= now) {
                sink->work(now);
            }
        }
    }
}

void Gateway::publish_counters(bus::Tick const& tick) {
    if (!statistics_->due(tick.time, tick.final)) {
        return;
    }
    for (std::size_t i = 0; i < routes_.size(); ++i) {
        rows_[i]->refused(0);
        sinks_[i]->report(*rows_[i]);
        sources_[i]->report(*rows_[i]);
    }
    for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
        subscriptions_[i]->report(*rows_[routes_.size() + i]);
    }
    auto const& sent = port_->sent_counters();
    for (StreamStatistics* row : rows_) {
        row->dropped(row->direction() == STREAM_SENT ? sent.send_failed : port_->dropped());
    }
    statistics_->publish(tick.time);
    if (first_line_ != nullptr) {
        first_line_->report(tick.time);
    }
    if (counters_ == nullptr) {
        return;
    }
    std::array<double, 3> row{};
    for (Sampled const& sampled : sampled_) {
        row[0] += static_cast<double>(sampled.sink->sent());
        row[1] += static_cast<double>(sampled.sink->late());
        row[2] += static_cast<double>(sampled.sink->underruns());
    }
    counters_->row(tick.time, row);
    counters_->flush();
    for (Sampled const& sampled : sampled_) {
        if (tick.final && sampled.ages != nullptr) {
            sampled.ages->flush();
        }
    }
}

void Gateway::publish_ages() {
    if (!clock_.known_start_unix_ns()) {
        return; // they wait
    }
    for (Sampled const& sampled : sampled_) {
        double const rate_hz = sampled.sink->stream().rate_hz.to_double();
        for (SampleSink::Departure d; sampled.sink->pop_departure(d);) {
            double const time_s = static_cast<double>(d.index) / rate_hz;
            double const age_ms = clock_.age_ms(d.unix_ns, time_s, settings_.wire.speed);
            sampled.ages->row(node_.time_base().from_nanoseconds(std::llround(time_s * 1e9)), {&age_ms, 1});
        }
    }
}

int run_gateway(GatewayProgram const& program, GatewaySettings& settings, int argc, char** argv) {
    program::Declaration const declaration = program.declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) {
                            program.describe(f);
                            describe_wire(f, settings.wire);
                        },
                        [&](config::Diagnostics& diagnostics) {
                            if (!program.complete) { // presets are checked when they know who they are
                                (void)make_routes(settings.gateway, settings.wire.streams, bus::idl_of_type,
                                                  diagnostics);
                            }
                        },
                        [&](DaemonRun& run) {
                            if (program.complete) {
                                program.complete(settings, run.bus);
                            }
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                auto const guest = program.guest ? program.guest(run) : nullptr;
                                Gateway gateway{settings, run, node, guest.get()};
                                return bus::run_member(node, gateway);
                            });
                        },
                        true,
                        program.declaration};
    return run_daemon(daemon, argc, argv);
}

} // namespace gridspace::gateways
