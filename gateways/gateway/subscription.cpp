// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/subscription.hpp"

#include "gateways/port/statistics.hpp"
#include "gateways/port/subscriptions.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

using iec61850::GooseSupervision;
using iec61850::SvSupervision;

std::variant<GooseSupervision, SvSupervision> supervision_of(SubscriptionConfig const& config,
                                                             streams::Stream const& stream, double speed) {
    if (stream.kind == streams::Kind::goose) {
        auto subscription = goose_subscription(stream);
        subscription.simulation = config.accept_test;
        return GooseSupervision{std::move(subscription)};
    }
    auto subscription = sv_subscription(stream, speed);
    subscription.simulation = config.accept_test;
    return SvSupervision{std::move(subscription), stream.data_set};
}

} // namespace

Subscription::Subscription(WireClock const& clock, SubscriptionConfig const& config, streams::Stream const& stream,
                           double speed)
    : clock_{clock}, stream_{stream}, supervision_{supervision_of(config, stream, speed)},
      watched_{watched_leaves(config, stream)}, layout_{stream.data_set} {}

Result<std::unique_ptr<Subscription>> Subscription::create(bus::Node& node, WireClock const& clock,
                                                           SubscriptionConfig const& config,
                                                           streams::Stream const& stream, double speed,
                                                           std::size_t number) {
    auto out = std::unique_ptr<Subscription>{new Subscription{clock, config, stream, speed}};
    auto signals = bus::SignalPublisher::create(node, fmt::format("subscription{}", number),
                                                subscription_signals(config, stream), {});
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    out->signals_ = std::move(*signals);
    return out;
}

iec61850::SupervisionState const& Subscription::state() const {
    return std::visit([](auto const& s) -> iec61850::SupervisionState const& { return s.state(); }, supervision_);
}

void Subscription::announce(SimTime now) {
    signals_->announce(now);
    publish(now);
}

void Subscription::receive(Moment at, iec61850::SvFrame const& frame) {
    auto* const supervision = std::get_if<SvSupervision>(&supervision_);
    if (supervision == nullptr) {
        return;
    }
    for (iec61850::Asdu const& asdu : frame.view()) {
        if (!supervision->subscriber().is_mine(asdu)) {
            continue;
        }
        if (auto const until = deadline(); until && *until < at.arrival_ns()) {
            expire(at); // nobody looked meanwhile
        }
        auto const taken = supervision->subscriber().counters().samples;
        bool const changed = supervision->receive(frame.header, asdu, at.arrival_ns());
        bool const newer = supervision->subscriber().counters().samples > taken;
        if (newer && !watched_.empty()) {
            sample_.assign(asdu.sample.begin(), asdu.sample.end());
        }
        if (changed || (newer && !watched_.empty())) {
            publish(at.time);
        }
    }
}

void Subscription::receive(Moment at, iec61850::GooseFrame const& message) {
    auto* const supervision = std::get_if<GooseSupervision>(&supervision_);
    if (supervision == nullptr || message.gocb_ref != stream_.control_block) {
        return;
    }
    if (auto const until = deadline(); until && *until < at.arrival_ns()) {
        expire(at);
    }
    if (supervision->receive(message, at.arrival_ns(), clock_.utc_at(at.arrival_ns()))) {
        publish(at.time);
    }
}

std::optional<std::int64_t> Subscription::deadline() const {
    return std::visit([](auto const& s) { return s.deadline(); }, supervision_);
}

void Subscription::expire(Moment at) {
    if (std::visit([&](auto& s) { return s.expire(at.ns); }, supervision_)) {
        publish(at.time);
    }
}

void Subscription::publish(SimTime time) {
    iec61850::SupervisionState const& s = state();
    row_ = {s.alive ? 1.0 : 0.0,
            s.simulated ? 1.0 : 0.0,
            s.needs_commissioning ? 1.0 : 0.0,
            static_cast<double>(s.problem),
            static_cast<double>(s.conf_rev),
            static_cast<double>(s.counter),
            static_cast<double>(s.quality)};
    for (std::size_t const leaf : watched_) {
        if (auto const* const goose = std::get_if<GooseSupervision>(&supervision_)) {
            row_.push_back(goose->subscriber().value(leaf).number());
        } else {
            row_.push_back(sample_.empty() ? 0.0 : layout_.read(leaf, sample_).number());
        }
    }
    if (row_ != last_) {
        signals_->row(time, row_);
        last_ = row_;
    }
}

void Subscription::report(StreamStatistics& out) const {
    std::visit([&](auto const& s) { report_received(out, s.subscriber()); }, supervision_);
}

} // namespace gridspace::gateways
