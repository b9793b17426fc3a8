// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/trip_publisher.hpp"

#include "gateways/port/subscriptions.hpp"

#include <array>
#include <fmt/format.h>

namespace gridspace::relay {

Result<std::unique_ptr<TripPublisher>> TripPublisher::create(bus::Node& node, gateways::WirePort& port,
                                                             streams::Stream const& stream, std::string const& field) {
    auto frame = stream.goose_template(port.mac());
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    auto const leaf = frame->index_of(field);
    if (!leaf || frame->leaves()[*leaf].type != iec61850::BasicType::boolean) {
        return fail(ExitCode::usage, fmt::format("stream '{}' has no Boolean member '{}'", stream.name.name, field),
                    "see trip_field");
    }
    auto out = std::unique_ptr<TripPublisher>{new TripPublisher{node, port}};
    out->leaf_ = *leaf;
    out->time_leaf_ = iec61850::time_next_to(frame->leaves(), *leaf);
    out->publisher_ = std::make_unique<iec61850::GoosePublisher>(std::move(*frame), stream.conf_rev,
                                                                 gateways::goose_publisher_params(stream));
    std::string const prefix = "stream." + stream.name.name + ".";
    auto signals = bus::SignalPublisher::create(node, "goose", 0,
                                                {{prefix + "st_num", ""},
                                                 {prefix + "sq_num", ""},
                                                 {prefix + "interval_ms", "ms"},
                                                 {prefix + "sent_after_ms", "ms"}});
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    out->signals_ = std::move(*signals);
    return out;
}

void TripPublisher::announce(SimTime now) {
    signals_->announce(now);
}

void TripPublisher::start(std::int64_t now_ns) {
    publisher_->set(leaf_, iec61850::Value::of(false));
    publisher_->start(now_ns, clock_.utc_ns(now_ns));
    stamp();
}

/// The member `t` beside the trip, if there is one, is the time of the state that begins.
void TripPublisher::stamp() {
    if (time_leaf_) {
        publisher_->set(*time_leaf_, iec61850::Value::of(publisher_->state().t));
    }
}

void TripPublisher::set(bool trip, std::int64_t at_ns) {
    changes_.push_back({at_ns, trip});
}

std::optional<std::int64_t> TripPublisher::due() const {
    std::optional<std::int64_t> due = publisher_->due();
    if (!changes_.empty()) {
        due = due ? std::min(*due, changes_.front().at_ns) : changes_.front().at_ns;
    }
    return due;
}

void TripPublisher::work(std::int64_t now_ns) {
    if (!changes_.empty() && changes_.front().at_ns <= now_ns) {
        publisher_->set(leaf_, iec61850::Value::of(changes_.front().trip));
        if (publisher_->commit(now_ns, clock_.utc_ns(now_ns))) {
            stamp();
        }
        changes_.pop_front();
    }
    iec61850::Octets const frame = publisher_->take(now_ns);
    if (frame.empty()) {
        return;
    }
    SimTime const at = clock_.sim_time(now_ns);
    double const sent_after_ms = clock_.since_start_ms(now_ns);
    port_.send(frame, at);
    ++sent_;
    iec61850::GooseState const& state = publisher_->state();
    double const interval_ms = last_sent_ns_ ? static_cast<double>(now_ns - *last_sent_ns_) / 1e6 : 0;
    last_sent_ns_ = now_ns;
    std::array<double, 4> const row{static_cast<double>(state.st_num), static_cast<double>(state.sq_num), interval_ms,
                                    sent_after_ms};
    signals_->row(at, row);
}

} // namespace gridspace::relay
