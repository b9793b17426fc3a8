// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-mu: a merging unit; sampled line currents from DDS onto the process bus as sampled values.
#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "common/log.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/mu/mu_config.hpp"
#include "gateways/mu/scheduled_sender.hpp"
#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"

#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <protection.h>

namespace gridspace::gateways {
namespace {

struct Settings {
    MuConfig mu;
    WireConfig wire;
};

void describe(config::Fields& f, Settings& s) {
    describe(f, s.mu);
    describe_wire(f, s.wire);
}

class MergingUnit {
  public:
    MergingUnit(Settings const& settings, bus::Node& node)
        : settings_{settings}, node_{node}, latency_{node.time_base().ceil(settings.mu.latency_us / Rational{1'000'000})} {}

    Result<void> run() {
        if (auto ok = prepare(); !ok) {
            return ok;
        }
        while (true) {
            auto tick = node_.next();
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            if (!*tick) {
                return {};
            }
            if (!announced_) {
                signals_->announce((*tick)->time);
                if (ages_ != nullptr) {
                    ages_->announce((*tick)->time);
                }
                announced_ = true;
            }
            for (auto const& received : currents_->take()) {
                send(received.value);
            }
            publish_ages();
            publish_counters((*tick)->time, (*tick)->final);
            port_->maintain();
            if (auto ok = node_.done(**tick, (*tick)->number + 1); !ok) {
                return ok;
            }
        }
    }

  private:
    Result<void> prepare() {
        config::Diagnostics diagnostics;
        streams::Stream const* stream = stream_of(settings_.wire.streams, settings_.mu.to, streams::Kind::smv, diagnostics);
        if (stream == nullptr) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        auto port = WirePort::open(node_, settings_.wire, {{stream->ethertype()}, {}});
        if (!port) {
            return std::unexpected{port.error()};
        }
        port_ = std::move(*port);
        auto frame = stream->sv_template(port_->mac());
        if (!frame) {
            return std::unexpected{frame.error()};
        }
        publisher_ = std::make_unique<iec61850::SvPublisher>(std::move(*frame), static_cast<std::uint32_t>(stream->rate_hz.num()));
        layout_ = std::make_unique<iec61850::SvLayout>(stream->data_set);
        for (std::size_t phase = 0; phase < 3; ++phase) {
            auto const slot = layout_->index_of(settings_.mu.channels[phase]);
            if (!slot) {
                return fail(ExitCode::usage, fmt::format("stream '{}' has no member '{}'", stream->name.name, settings_.mu.channels[phase]));
            }
            slots_[phase] = *slot;
            scales_[phase] = iec61850::is_integer(layout_->slots()[*slot].leaf.type) ? 1000.0 : 1.0; // 9-2LE counts milliamperes
        }
        auto reader = node_.reader<LineCurrents>(settings_.mu.from.name);
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        currents_ = std::move(*reader);
        std::string const prefix = "publisher." + node_.config().process + ".";
        auto signals = bus::SignalPublisher::create(node_, "publisher", 1, {{prefix + "sent", ""}, {prefix + "late", ""}, {prefix + "underruns", ""}});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        rate_hz_ = stream->rate_hz;
        if (!node_.lockstep()) {
            auto ages = bus::SignalPublisher::create(node_, "age", rate_hz_.to_double(), {{"stream." + stream->name.name + ".publish_age_ms", "ms"}});
            if (!ages) {
                return std::unexpected{ages.error()};
            }
            ages_ = std::move(*ages);
        }
        if (!node_.lockstep() && settings_.mu.sending == MuConfig::Sending::scheduled) {
            sender_ = std::make_unique<ScheduledSender>(
                ScheduledSender::Params{stream->rate_hz.to_double() * settings_.wire.speed, settings_.mu.buffer_ms / 1e3},
                [this](ScheduledSender::Sample const& sample) { send(sample.index, sample.i_a, {}); });
        }
        return node_.start();
    }

    void send(LineCurrents const& message) {
        // The instant of a sample is exact: index / rate, on the time grid.
        Rational const period_quanta = Rational{message.rate_den()} / Rational{message.rate_num()} / node_.time_base().quantum_s();
        auto const quanta = period_quanta.num() / period_quanta.den();
        auto index = static_cast<std::int64_t>(message.first_index());
        for (PhaseCurrents const& currents : message.samples()) {
            std::array<float, 3> const i_a{currents.ia(), currents.ib(), currents.ic()};
            if (sender_ != nullptr) {
                sender_->push({index, i_a});
            } else {
                send(index, i_a, SimTime{index * quanta} + latency_);
            }
            ++index;
        }
    }

    /// On the sender's thread in real time, scheduled; otherwise on the process's own.
    void send(std::int64_t index, std::array<float, 3> const& i_a, SimTime at) {
        std::span<std::uint8_t> const sample = publisher_->sample(index);
        for (std::size_t phase = 0; phase < 3; ++phase) {
            auto const type = layout_->slots()[slots_[phase]].leaf.type;
            layout_->write(slots_[phase], iec61850::Value::from_number(type, static_cast<double>(i_a[phase]) * scales_[phase]), sample);
        }
        if (auto const frame = publisher_->commit(); !frame.empty()) {
            if (ages_ != nullptr) {
                departures_.push({index, clock_.utc_ns(0)}); // when it is handed to the kernel
            }
            port_->send(frame, at);
            ++sent_;
        }
    }

    void publish_ages() {
        for (Departure d; departures_.pop(d);) {
            double const time_s = static_cast<double>(d.index) / rate_hz_.to_double();
            double const age_ms = clock_.age_ms(d.unix_ns, time_s, settings_.wire.speed);
            ages_->row(node_.time_base().from_nanoseconds(std::llround(time_s * 1e9)), {&age_ms, 1});
        }
    }

    void publish_counters(SimTime now, bool final) {
        auto const second = static_cast<std::int64_t>(node_.time_base().seconds(now));
        if (second == last_second_ && !final) {
            return;
        }
        last_second_ = second;
        auto const counters = sender_ == nullptr ? ScheduledSender::Counters{} : sender_->counters();
        std::array<double, 3> const row{static_cast<double>(sent_.load()), static_cast<double>(counters.late), static_cast<double>(counters.underruns)};
        signals_->row(now, row);
        signals_->flush();
        if (final && ages_ != nullptr) {
            ages_->flush();
        }
    }

    Settings const& settings_;
    bus::Node& node_;
    SimSpan latency_;
    Rational rate_hz_{4800};
    std::unique_ptr<WirePort> port_;
    std::unique_ptr<iec61850::SvPublisher> publisher_;
    std::unique_ptr<iec61850::SvLayout> layout_;
    std::array<std::size_t, 3> slots_{};
    std::array<double, 3> scales_{};
    std::shared_ptr<bus::Reader<LineCurrents>> currents_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    struct Departure {
        std::int64_t index{0}, unix_ns{0};
    };
    WireClock clock_{node_};
    SpscRing<Departure> departures_{8192};
    std::unique_ptr<bus::SignalPublisher> ages_; ///< real time
    std::atomic<std::uint64_t> sent_{0};
    std::int64_t last_second_{-1};
    bool announced_{false};
    std::unique_ptr<ScheduledSender> sender_; ///< last: its thread uses what stands above
};

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace;
    gateways::Settings settings;
    Daemon const daemon{"gridspace-mu", "merging unit: sampled line currents onto the process bus",
                        [&](config::Fields& f) { describe(f, settings); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> { return gateways::MergingUnit{settings, node}.run(); });
                        }};
    return run_daemon(daemon, argc, argv);
}
