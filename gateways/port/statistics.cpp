// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/statistics.hpp"

namespace gridspace::gateways {

using iec61850::GooseEvent;
using iec61850::SvEvent;

namespace {

void report_arrivals(StreamStatistics& out, iec61850::ArrivalStatistics const& arrivals) {
    out.rate_hz(arrivals.rate_hz());
    out.shortest_gap_ms(static_cast<double>(arrivals.shortest_ns()) / 1e6);
    out.longest_gap_ms(static_cast<double>(arrivals.longest_ns()) / 1e6);
}

} // namespace

Result<std::unique_ptr<StatisticsPublisher>> StatisticsPublisher::create(bus::Node& node) {
    auto out = std::unique_ptr<StatisticsPublisher>{new StatisticsPublisher{node}};
    auto writer = node.writer<StreamStatistics>("stream_statistics");
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    out->writer_ = std::move(*writer);
    return out;
}

StreamStatistics& StatisticsPublisher::add(std::string const& stream, StreamDirection direction) {
    rows_.push_back(std::make_unique<StreamStatistics>());
    StreamStatistics& row = *rows_.back();
    row.process(node_.config().process.c_str());
    row.stream(stream.c_str());
    row.direction(direction);
    row.state(STREAM_WAITING);
    return row;
}

bool StatisticsPublisher::due(SimTime now, bool final) {
    auto const second = static_cast<std::int64_t>(node_.time_base().seconds(now));
    if (second == last_second_ && !final) {
        return false;
    }
    last_second_ = second;
    return true;
}

void StatisticsPublisher::publish(SimTime now) {
    for (auto const& row : rows_) {
        row->time_ns(node_.time_base().nanoseconds(now));
        writer_->write(*row, now);
    }
}

void report_received(StreamStatistics& out, iec61850::SvSubscriber const& subscriber) {
    auto const& counters = subscriber.counters();
    out.state(subscriber.alive() ? STREAM_ALIVE : counters.samples > 0 ? STREAM_LOST : STREAM_WAITING);
    out.frames(counters.samples);
    out.lost(subscriber.lost_for_good());
    out.duplicate(counters.of(SvEvent::duplicate));
    out.late(counters.of(SvEvent::late));
    out.restarts(counters.of(SvEvent::restart));
    out.refused(counters.of(SvEvent::identity_mismatch) + counters.of(SvEvent::conf_rev_mismatch) +
                counters.of(SvEvent::size_mismatch) + counters.of(SvEvent::simulation_refused) +
                counters.of(SvEvent::unconfirmed));
    out.silences(counters.silences);
    report_arrivals(out, subscriber.arrivals());
}

void report_received(StreamStatistics& out, iec61850::GooseSubscriber const& subscriber) {
    using iec61850::GooseStatus;
    auto const& counters = subscriber.counters();
    GooseStatus const status = subscriber.status();
    out.state(status == GooseStatus::good      ? STREAM_ALIVE
              : status == GooseStatus::expired ? STREAM_LOST
                                               : STREAM_WAITING);
    std::uint64_t taken = 0, refused = 0;
    for (std::size_t i = 0; i < iec61850::kGooseEvents; ++i) {
        auto const event = static_cast<GooseEvent>(i);
        if (event >= GooseEvent::first && event <= GooseEvent::restart) {
            taken += counters.of(event);
        } else if (event > GooseEvent::out_of_order) {
            refused += counters.of(event);
        }
    }
    out.frames(taken);
    out.lost(counters.lost);
    out.duplicate(counters.of(GooseEvent::duplicate) + counters.of(GooseEvent::out_of_order));
    out.restarts(counters.of(GooseEvent::restart));
    out.refused(refused);
    out.silences(counters.expired);
    report_arrivals(out, subscriber.arrivals());
}

void report_sent(StreamStatistics& out, iec61850::GoosePublisher::Counters const& counters) {
    out.state(counters.sent > 0 ? STREAM_ALIVE : STREAM_WAITING);
    out.frames(counters.sent);
    out.late(counters.late);
    out.refused(counters.refused);
}

} // namespace gridspace::gateways
