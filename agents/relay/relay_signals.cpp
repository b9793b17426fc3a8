// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_signals.hpp"

#include "agents/relay/relay_declaration.hpp"

namespace gridspace::relay {

Result<std::unique_ptr<RelaySignals>> RelaySignals::create(bus::Node& node, RelayConfig const& config, double rate_hz) {
    auto out = std::unique_ptr<RelaySignals>{new RelaySignals{node}};
    auto statistics = gateways::StatisticsPublisher::create(node);
    if (!statistics) {
        return std::unexpected{statistics.error()};
    }
    out->statistics_ = std::move(*statistics);
    std::vector<Ref> const inputs = config.inputs();
    out->streams_ = inputs.size();
    for (Ref const& stream : inputs) {
        out->rows_.push_back(&out->statistics_->add(stream.name, STREAM_RECEIVED));
    }
    out->rows_.push_back(&out->statistics_->add(config.trip.name, STREAM_SENT));
    auto state = bus::SignalPublisher::create(node, "relay", state_signals(), {});
    if (!state) {
        return std::unexpected{state.error()};
    }
    out->state_ = std::move(*state);
    std::vector<program::Signal> received;
    for (Ref const& stream : inputs) {
        gateways::add(received, received_signals(stream, !out->clock_.simulated()));
    }
    auto counters = bus::SignalPublisher::create(node, "streams", received, {});
    if (!counters) {
        return std::unexpected{counters.error()};
    }
    out->counters_ = std::move(*counters);
    if (auto ok = out->clock_.simulated() ? Result<void>{} : out->open_ages(config, rate_hz); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = config.logic.publish_values ? out->open_element(rate_hz) : Result<void>{}; !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

/// The times of these rows are those of the samples that complete the window.
Result<void> RelaySignals::open_element(double rate_hz) {
    auto element = bus::SignalPublisher::create(node_, "element", rate_hz,
                                                bus::SignalPublisher::columns_of(node_, element_signals()));
    if (!element) {
        return std::unexpected{element.error()};
    }
    element_ = std::move(*element);
    return {};
}

/// The times of these rows are those of the samples.
Result<void> RelaySignals::open_ages(RelayConfig const& config, double rate_hz) {
    auto const open = [&](char const* group, program::Signal age) {
        return bus::SignalPublisher::create(node_, group, rate_hz,
                                            bus::SignalPublisher::columns_of(node_, {std::move(age)}));
    };
    std::vector<Ref> const streams = config.inputs();
    for (std::size_t i = 0; i < streams.size(); ++i) {
        auto arrivals = open(i == 0 ? "arrival_from" : "arrival_to", arrival_age(streams[i]));
        if (!arrivals) {
            return std::unexpected{arrivals.error()};
        }
        arrival_ages_[i] = std::move(*arrivals);
    }
    auto decisions = open("decision", decision_age());
    if (!decisions) {
        return std::unexpected{decisions.error()};
    }
    decision_ages_ = std::move(*decisions);
    return {};
}

std::vector<bus::SignalPublisher*> RelaySignals::all() const {
    std::vector<bus::SignalPublisher*> out{state_.get(), counters_.get()};
    for (auto const* some : {&arrival_ages_[0], &arrival_ages_[1], &decision_ages_, &element_}) {
        if (*some != nullptr) {
            out.push_back(some->get());
        }
    }
    return out;
}

void RelaySignals::announce(SimTime now) {
    for (bus::SignalPublisher* signals : all()) {
        signals->announce(now);
    }
}

void RelaySignals::flush() {
    for (bus::SignalPublisher* signals : all()) {
        signals->flush();
    }
}

void RelaySignals::state(SimTime now, bool pickup, bool trip, bool blocked, double sample_s) {
    std::array<double, 4> const row{pickup ? 1.0 : 0.0, trip ? 1.0 : 0.0, blocked ? 1.0 : 0.0, sample_s};
    state_->row(now, row);
}

void RelaySignals::arrived(std::size_t end, std::int64_t index, std::int64_t unix_ns, SampleTime const& time) {
    publish_age(arrival_ages_.at(end).get(), index, unix_ns, time);
}

void RelaySignals::decided(std::int64_t index, std::int64_t unix_ns, SampleTime const& time) {
    publish_age(decision_ages_.get(), index, unix_ns, time);
}

void RelaySignals::publish_age(bus::SignalPublisher* ages, std::int64_t index, std::int64_t unix_ns,
                               SampleTime const& time) {
    if (ages != nullptr && time.was_known_on_arrival()) {
        double const age_ms = time.age_ms(index, unix_ns);
        ages->row(instant(index, time), {&age_ms, 1});
    }
}

SimTime RelaySignals::instant(std::int64_t index, SampleTime const& time) const {
    return node_.time_base().from_nanoseconds(std::llround(time.instant_s(index) * 1e9));
}

void RelaySignals::element(std::int64_t index, ElementValues const& values, SampleTime const& time) {
    if (element_ == nullptr || !time.is_known()) {
        return;
    }
    std::array<double, 9> row{};
    for (std::size_t p = 0; p < 3; ++p) {
        row[p] = values.differential_a[p];
        row[3 + p] = values.restraint_a[p];
        row[6 + p] = values.operate_at_a[p];
    }
    element_->row(instant(index, time), row);
}

bool RelaySignals::due(SimTime now, bool final) {
    auto const second = static_cast<std::int64_t>(node_.time_base().seconds(now));
    bool const again = second != reported_ || final;
    reported_ = second;
    return again;
}

void RelaySignals::report_statistics(SimTime now, CurrentInputs const& inputs, TripPublisher const& trip,
                                     gateways::WirePort& port) {
    for (std::size_t i = 0; i < streams_; ++i) {
        gateways::report_received(*rows_[i], inputs.end(i).subscriber);
        rows_[i]->refused(rows_[i]->refused() + inputs.end(i).first_line.refused());
        rows_[i]->dropped(port.dropped());
    }
    gateways::report_sent(*rows_.back(), trip.counters());
    rows_.back()->dropped(port.sent_counters().send_failed);
    statistics_->publish(now);
}

bool RelaySignals::report_counters(SimTime now, bool final, CurrentInputs const& inputs) {
    std::array<double, 14> row{};
    std::size_t const columns = clock_.simulated() ? 6 : 7;
    std::int64_t const wall = clock_.now();
    for (std::size_t i = 0; i < streams_; ++i) {
        using iec61850::SvEvent;
        auto const& c = inputs.end(i).subscriber.counters();
        double* out = row.data() + columns * i;
        out[0] = static_cast<double>(c.samples);
        // What is overtaken may still come: at the end it is lost.
        out[1] = static_cast<double>(final ? c.lost : inputs.end(i).subscriber.lost_for_good());
        out[2] = static_cast<double>(c.of(SvEvent::duplicate));
        out[3] = static_cast<double>(c.of(SvEvent::late));
        out[4] = static_cast<double>(c.of(SvEvent::identity_mismatch) + c.of(SvEvent::conf_rev_mismatch) +
                                     c.of(SvEvent::size_mismatch) + c.of(SvEvent::simulation_refused) +
                                     inputs.damaged().total());
        out[5] = static_cast<double>(c.silences);
        if (columns > 6) {
            // Between two reports, by the wall clock; the first one has nothing to compare with.
            double const seconds = static_cast<double>(wall - reported_wall_ns_) / 1e9;
            out[6] = reported_wall_ns_ == 0 ? 0 : static_cast<double>(c.samples - reported_samples_[i]) / seconds;
            reported_samples_[i] = c.samples;
        }
    }
    bool const nothing_to_compare = reported_wall_ns_ == 0;
    reported_wall_ns_ = wall;
    if (columns > 6 && nothing_to_compare) {
        return false;
    }
    counters_->row(now, std::span{row}.first(columns * streams_));
    return true;
}

} // namespace gridspace::relay
