// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-relay: line differential protection; two streams of sampled values in, a trip by GOOSE out.
#include "agents/relay/relay_parts.hpp"
#include "agents/relay/relay_program.hpp"
#include "bus/member.hpp"
#include "common/log.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::relay {
namespace {

using gateways::WireClock;
using gateways::WirePort;

class RelayAgent final : public bus::Member {
  public:
    RelayAgent(RelaySettings const& settings, DaemonRun& run, bus::Node& node)
        : settings_{settings}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock},
          latency_ns_{clock_.lasting(node.time_base().ceil(settings.relay.latency_us / Rational{1'000'000}),
                                     settings.wire.speed)} {}

    Result<void> prepare() override {
        auto parts = make_parts(settings_, run_, node_);
        if (!parts) {
            return std::unexpected{parts.error()};
        }
        parts_ = std::move(*parts);
        time_.emplace(node_, parts_.rate_hz, settings_.wire.speed);
        parts_.inputs->on_silence(
            [this](std::size_t end) { act_on(parts_.relay->relay().lost(end == 0 ? kFromLost : kToLost)); });
        if (parts_.first_line != nullptr) {
            parts_.inputs->on_finding([this](std::size_t end, std::uint32_t findings, iec61850::Mac const& source) {
                parts_.first_line->finding(end, findings, source, now());
            });
        }
        return {};
    }

    void begin(bus::Tick const& tick) override {
        parts_.signals->announce(tick.time);
        if (parts_.intrusion != nullptr) {
            parts_.intrusion->announce(tick.time);
        }
        if (parts_.first_line != nullptr) {
            parts_.first_line->announce(tick.time);
        }
        parts_.trip->announce(tick.time);
        now_ns_ = clock_.at_tick(tick.time);
        parts_.trip->start(now_ns_);
        blocked_ = parts_.relay->relay().output().blocked != 0; // also when no sample ever comes
        publish_state();
    }

    Result<void> work(bus::Tick const& tick) override {
        if (clock_.simulated()) {
            work_through(tick.time);
        } else {
            work_now();
        }
        report(tick);
        parts_.port->maintain();
        return {};
    }

    std::uint64_t next_tick(bus::Tick const& tick) const override {
        auto const work = next_work();
        return work ? grid_.tick_of(clock_.at_or_after(*work)) : tick.number + 1;
    }

    std::optional<std::chrono::steady_clock::time_point> deadline() const override {
        auto const work = next_work();
        return work ? std::optional{WireClock::wall(*work)} : std::nullopt;
    }

  private:
    [[nodiscard]] std::optional<std::int64_t> next_work() const {
        auto out = parts_.trip->due();
        if (auto const deadline = parts_.inputs->deadline()) {
            out = out ? std::min(*out, *deadline) : *deadline;
        }
        return out;
    }

    /// Does everything that time alone asks for, up to and including `until_ns`, in its order.
    void elapse(std::int64_t until_ns) {
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
    void work_through(SimTime end) {
        // Who was paused finds frames of ticks that are over; what it does about them, it does now.
        now_ns_ = std::max(now_ns_, clock_.of(end - node_.time_base().nearest(node_.config().clock.tick_s)));
        for (bus::WireFrame const* frame : parts_.port->take(iec61850::kSvEthertype)) {
            std::int64_t const at = clock_.of(frame->time);
            elapse(at - 1); // at equal times the frame comes first
            now_ns_ = std::max(now_ns_, at);
            parts_.inputs->frame(WirePort::octets(*frame), now_ns_, on_pair_);
        }
        elapse(clock_.of(end));
    }

    /// Everything that has come by now.
    void work_now() {
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
    void take_frames() {
        for (bus::WireFrame const* frame : parts_.port->take(iec61850::kSvEthertype)) {
            now_ns_ = clock_.now();
            time_->came(frame->arrived_ns, now_ns_);
            std::array<std::uint64_t, 2> const before{samples_of(0), samples_of(1)};
            parts_.inputs->elapse(frame->arrived_ns - 1, on_pair_); // at equal times the frame comes first
            parts_.inputs->frame(WirePort::octets(*frame), frame->arrived_ns, on_pair_);
            for (std::size_t i = 0; i < 2; ++i) {
                if (samples_of(i) != before[i] && frame->kernel_ns != 0) {
                    parts_.signals->arrived(i, parts_.inputs->end(i).subscriber.last_index(), frame->kernel_ns, *time_);
                }
            }
        }
    }

    [[nodiscard]] std::uint64_t samples_of(std::size_t end) const {
        return parts_.inputs->end(end).subscriber.counters().samples;
    }

    void pair(LineSample const& sample) {
        RelayOutput const& out = parts_.intrusion == nullptr ? parts_.relay->step(sample) : guarded(sample);
        if (parts_.event_report != nullptr) {
            parts_.event_report->sample(sample, out, time_->utc_ns(sample.index));
        }
        if (sample.from.present && sample.to.present) {
            parts_.signals->decided(sample.index, clock_.utc_ns(0), *time_);
        }
        act_on(out);
    }

    /// Detector and relay, the detector's time taken.
    RelayOutput const& guarded(LineSample const& sample) {
        std::int64_t const before = processor_time_ns();
        parts_.relay->judge(sample);
        std::int64_t const took_ns = processor_time_ns() - before;
        RelayOutput const& out = parts_.relay->decide(sample);
        double const instant_s = time_->instant_s(sample.index);
        parts_.intrusion->sample(*parts_.relay->detector(), std::llround(instant_s * parts_.rate_hz),
                                 std::llround(instant_s * 1e9), now(), took_ns);
        return out;
    }

    void act_on(RelayOutput const& out) {
        if (out.pickup != pickup_ || out.trip != tripped_ || (out.blocked != 0) != blocked_) {
            bool const changed = out.trip != tripped_;
            pickup_ = out.pickup;
            tripped_ = out.trip;
            blocked_ = out.blocked != 0;
            publish_state();
            if (changed && settings_.relay.trip_output == RelayConfig::TripOutput::enabled) {
                parts_.trip->set(tripped_, now_ns_ + latency_ns_); // in real time at least so late: a hold-back
            }
        }
        publish_events();
    }

    [[nodiscard]] SimTime now() const { return clock_.sim_time(now_ns_); }

    void publish_state() {
        if (time_->is_known()) {
            parts_.signals->state(now(), pickup_, tripped_, blocked_,
                                  time_->instant_s(parts_.relay->relay().output().index));
        }
    }

    /// Also while it stays blocked: another reason is an event of its own.
    void publish_events() {
        parts_.relay->relay().events().drain([&](RelayEvent const& event) {
            std::string const text = text_of(event);
            if (parts_.event_report != nullptr) {
                parts_.event_report->event(
                    fmt::format("{:.6f} s  {}: {}", time_->instant_s(event.index), name_of(event.kind), text));
            }
            log::info("{}: {}", name_of(event.kind), text);
            if (time_->is_known()) { // what was before is in the log; it is no event of the run
                run_.status.event(node_.time_base().seconds(now()), node_.config().process, name_of(event.kind), text);
            }
        });
    }

    static std::string text_of(RelayEvent const& event) {
        std::string text = fmt::format("sample {}", event.index);
        if (event.phases != 0) {
            text += fmt::format(", phases {}, {:.1f} {:.1f} {:.1f} A", phase_names(event.phases),
                                event.differential_a[0], event.differential_a[1], event.differential_a[2]);
        }
        return event.reasons != 0 ? text + ": " + block_names(event.reasons) : text;
    }

    /// Counters once per simulated second.
    void report(bus::Tick const& tick) {
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
        if (parts_.intrusion != nullptr) {
            parts_.intrusion->report(*parts_.relay->detector(), tick.time);
            parts_.intrusion->flush(tick.time, tick.final);
        }
        parts_.signals->flush();
    }

    RelaySettings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    WireClock clock_;
    bus::TickGrid grid_;
    std::int64_t latency_ns_;
    RelayParts parts_;
    std::optional<SampleTime> time_; ///< after prepare()
    CurrentInputs::OnPair on_pair_{[this](LineSample const& sample) { pair(sample); }};
    std::int64_t now_ns_{0};
    bool pickup_{false}, tripped_{false}, blocked_{false};
};

} // namespace
} // namespace gridspace::relay

int main(int argc, char** argv) {
    using namespace gridspace;
    relay::RelaySettings settings;
    Daemon const daemon{"gridspace-relay",
                        "line differential relay: sampled values in, trip by GOOSE out",
                        [&](config::Fields& f) {
                            describe(f, settings.relay);
                            gateways::describe_wire(f, settings.wire);
                        },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                relay::RelayAgent agent{settings, run, node};
                                return bus::run_member(node, agent);
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}
