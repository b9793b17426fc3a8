// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/trip_publisher.hpp"

#include "gateways/port/subscriptions.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::relay {

Result<std::unique_ptr<TripPublisher>> TripPublisher::create(bus::Node& node, gateways::WirePort& port,
                                                             streams::Stream const& stream,
                                                             std::vector<std::string> const& fields) {
    auto frame = stream.goose_template(port.mac());
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    auto out = std::unique_ptr<TripPublisher>{new TripPublisher{node, port}};
    for (std::string const& field : fields) {
        auto const leaf = frame->index_of(field);
        if (!leaf || frame->leaves()[*leaf].type != iec61850::BasicType::boolean) {
            return fail(ExitCode::usage, fmt::format("stream '{}' has no Boolean member '{}'", stream.name.name, field),
                        "see trip_field and outputs");
        }
        out->leaves_.push_back(*leaf);
    }
    out->time_leaf_ = iec61850::time_next_to(frame->leaves(), out->leaves_.front());
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
    for (std::size_t const leaf : leaves_) {
        publisher_->set(leaf, iec61850::Value::of(false));
    }
    publisher_->start(now_ns, clock_.utc_ns(now_ns));
    stamp(*publisher_);
}

/// The member `t` next to the trip, if there is one, is the time of the state that begins.
void TripPublisher::stamp(iec61850::GoosePublisher& publisher) const {
    if (time_leaf_) {
        publisher.set(*time_leaf_, iec61850::Value::of(publisher.state().t));
    }
}

void TripPublisher::set(bool state, std::int64_t at_ns, std::size_t field) {
    changes_.push_back({at_ns, field, state});
}

namespace {

std::optional<std::int64_t> earlier(std::optional<std::int64_t> due, std::deque<TripPublisher::Change> const& changes) {
    if (changes.empty()) {
        return due;
    }
    return due ? std::min(*due, changes.front().at_ns) : changes.front().at_ns;
}

} // namespace

std::optional<std::int64_t> TripPublisher::due() const {
    return earlier(publisher_->due(), changes_);
}

iec61850::Octets TripPublisher::advance(iec61850::GoosePublisher& publisher, std::deque<Change>& changes,
                                        std::int64_t now_ns) const {
    if (!changes.empty() && changes.front().at_ns <= now_ns) {
        Change last = changes.front();
        do { // fields in their order: one that comes again is a state of its own
            last = changes.front();
            publisher.set(leaves_[last.field], iec61850::Value::of(last.state));
            changes.pop_front();
        } while (!changes.empty() && changes.front().at_ns == last.at_ns && changes.front().field > last.field);
        if (publisher.commit(now_ns, clock_.utc_ns(now_ns))) {
            stamp(publisher);
        }
    }
    return publisher.take(now_ns);
}

void TripPublisher::send_ahead(std::int64_t until_ns) {
    auto const next = earlier(publisher_->due(), changes_);
    if (!next || clock_.on_grid(*next) > until_ns) {
        sent_ahead_ns_ = std::max(sent_ahead_ns_, until_ns);
        return; // as in most ticks
    }
    iec61850::GoosePublisher publisher = *publisher_;
    std::deque<Change> changes = changes_;
    std::int64_t now_ns = INT64_MIN;
    for (auto at = next; at; at = earlier(publisher.due(), changes)) {
        now_ns = std::max(now_ns, clock_.on_grid(*at));
        if (now_ns > until_ns) {
            break;
        }
        iec61850::Octets const frame = advance(publisher, changes, now_ns);
        if (!frame.empty() && now_ns > sent_ahead_ns_) {
            port_.send(frame, clock_.sim_time(now_ns));
        }
    }
    sent_ahead_ns_ = std::max(sent_ahead_ns_, until_ns);
}

void TripPublisher::work(std::int64_t now_ns) {
    iec61850::Octets const frame = advance(*publisher_, changes_, now_ns);
    if (frame.empty()) {
        return;
    }
    SimTime const at = clock_.sim_time(now_ns);
    double const sent_after_ms = clock_.since_start_ms(now_ns);
    if (now_ns > sent_ahead_ns_) {
        port_.send(frame, at);
    }
    ++sent_;
    iec61850::GooseState const& state = publisher_->state();
    double const interval_ms = last_sent_ns_ ? static_cast<double>(now_ns - *last_sent_ns_) / 1e6 : 0;
    last_sent_ns_ = now_ns;
    std::array<double, 4> const row{static_cast<double>(state.st_num), static_cast<double>(state.sq_num), interval_ms,
                                    sent_after_ms};
    signals_->row(at, row);
}

} // namespace gridspace::relay
