// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-relay: protection; streams of sampled values in, a trip by GOOSE out. The differential of a line, or the
// functions of a bay.
#include "agents/relay/relay_declaration.hpp"
#include "agents/relay/relay_member.hpp"
#include "common/duration_histogram.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::relay {
namespace {

class DifferentialRelay final : public RelayMember {
  public:
    using RelayMember::RelayMember;

  private:
    Result<void> prepare_relay() override {
        blocked_ = parts_.relay->relay().output().blocked != 0;
        return {};
    }

    void announce(SimTime now) override {
        if (parts_.intrusion != nullptr) {
            parts_.intrusion->announce(now);
        }
    }

    void silent(std::size_t end) override { act_on(parts_.relay->relay().lost(end == 0 ? kFromLost : kToLost)); }

    void pair(LineSample const& sample) override {
        RelayOutput const& out = parts_.foreign != nullptr     ? permitted(sample)
                                 : parts_.intrusion == nullptr ? parts_.relay->step(sample)
                                                               : guarded(sample);
        if (parts_.event_report != nullptr) {
            parts_.event_report->sample(sample, out, time_->utc_ns(sample.index));
        }
        if (out.evaluated) {
            parts_.signals->element(sample.index, out.values, *time_);
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

    /// The relay, with the permission of somebody else's detector.
    RelayOutput const& permitted(LineSample const& sample) {
        LineRelay& relay = parts_.relay->relay();
        std::int64_t const index = std::llround(time_->instant_s(sample.index) * parts_.rate_hz);
        bool const granted = parts_.foreign->step(index, relay.output().pickup, now());
        auto const reason = parts_.foreign->permission().reason();
        if (reason != reason_ && reason != ForeignPermission::Reason::none) {
            tell(granted ? "trip_permitted" : "trip_withheld",
                 fmt::format("{}{}{}", parts_.foreign->detector(), parts_.foreign->detector().empty() ? "" : ": ",
                             to_string(reason)));
        }
        reason_ = reason;
        return relay.step(sample, {granted});
    }

    void act_on(RelayOutput const& out) {
        if (out.pickup != pickup_ || out.trip != tripped_ || (out.blocked != 0) != blocked_) {
            bool const changed = out.trip != tripped_;
            pickup_ = out.pickup;
            tripped_ = out.trip;
            blocked_ = out.blocked != 0;
            publish_state();
            if (changed) {
                send(tripped_);
            }
        }
        publish_events();
    }

    void publish_state() override {
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
            tell(name_of(event.kind), text);
        });
    }

    static std::string text_of(RelayEvent const& event) {
        std::string text = fmt::format("sample {}", event.index);
        if (event.phases != 0) {
            text += fmt::format(", phases {}, differential {:.1f} {:.1f} {:.1f} A", phase_names(event.phases),
                                event.differential_a[0], event.differential_a[1], event.differential_a[2]);
        }
        return event.reasons != 0 ? text + ": " + block_names(event.reasons) : text;
    }

    void report_relay(bus::Tick const& tick) override {
        if (parts_.intrusion != nullptr) {
            parts_.intrusion->report(*parts_.relay->detector(), tick.time);
            parts_.intrusion->flush(tick.time, tick.final);
        }
    }

    bool pickup_{false}, tripped_{false}, blocked_{false};
    ForeignPermission::Reason reason_{ForeignPermission::Reason::none};
};

std::unique_ptr<RelayMember> make_relay(RelaySettings const& settings, DaemonRun& run, bus::Node& node) {
    if (settings.relay.is_of_bay()) {
        return make_function_relay(settings, run, node);
    }
    return std::make_unique<DifferentialRelay>(settings, run, node);
}

} // namespace
} // namespace gridspace::relay

int main(int argc, char** argv) {
    using namespace gridspace;
    relay::RelaySettings settings;
    program::Declaration const declaration = relay::relay_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) {
                            describe(f, settings.relay);
                            gateways::describe_wire(f, settings.wire);
                        },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                auto const agent = relay::make_relay(settings, run, node);
                                return bus::run_member(node, *agent);
                            });
                        },
                        true,
                        relay::relay_declaration};
    return run_daemon(daemon, argc, argv);
}
