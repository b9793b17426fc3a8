// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/first_line_report.hpp"

#include "common/log.hpp"
#include "gateways/port/declared_signals.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

std::string names_of(streams::Kind kind, std::uint32_t findings) {
    if (findings >> kFirstAuthenticityBit != 0) {
        return authenticity_names(findings);
    }
    return kind == streams::Kind::smv ? ids::sv_finding_names(findings) : ids::goose_finding_names(findings);
}

} // namespace

Result<std::unique_ptr<FirstLineReport>> FirstLineReport::create(bus::Node& node, DaemonRun& run,
                                                                 std::vector<Stream> streams,
                                                                 FrameAuthentication* authentication) {
    auto out = std::unique_ptr<FirstLineReport>{new FirstLineReport{node, run}};
    out->authentication_ = authentication;
    std::vector<GuardedStream> guarded;
    for (Stream const& stream : streams) {
        guarded.push_back({stream.name, stream.kind == streams::Kind::smv, out->authenticity(stream.name) != nullptr});
    }
    auto columns = bus::SignalPublisher::columns_of(node, first_line_counter_signals(guarded));
    out->row_.resize(columns.size());
    out->alarms_.resize(streams.size());
    out->streams_ = std::move(streams);
    auto state = bus::SignalPublisher::create(node, "first_line", std::vector{first_line_alarm()}, {});
    if (!state) {
        return std::unexpected{state.error()};
    }
    out->state_ = std::move(*state);
    auto counters = bus::SignalPublisher::create(node, "first_line_counters", 1, std::move(columns));
    if (!counters) {
        return std::unexpected{counters.error()};
    }
    out->counters_ = std::move(*counters);
    if (authentication != nullptr) {
        authentication->on_finding([report = out.get()](std::string const& stream, std::uint32_t findings,
                                                        iec61850::Mac const& source, SimTime time) {
            if (auto const i = report->place_of(stream)) {
                report->finding(*i, findings, source, time);
            }
        });
    }
    return out;
}

std::optional<std::size_t> FirstLineReport::place_of(std::string const& stream) const {
    auto const found =
        std::find_if(streams_.begin(), streams_.end(), [&](Stream const& s) { return s.name == stream; });
    return found == streams_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - streams_.begin())};
}

void FirstLineReport::announce(SimTime now) {
    state_->announce(now);
    counters_->announce(now);
    double const off = 0;
    state_->row(now, {&off, 1});
}

void FirstLineReport::publish_alarm(SimTime now) {
    bool const alarm = std::any_of(alarms_.begin(), alarms_.end(), [](FirstLineAlarm const& a) { return a.on(); });
    if (alarm != alarm_) {
        alarm_ = alarm;
        double const value = alarm ? 1 : 0;
        state_->row(now, {&value, 1});
    }
}

void FirstLineReport::finding(std::size_t i, std::uint32_t findings, iec61850::Mac const& source, SimTime now) {
    if (!alarms_[i].raise(findings)) {
        return; // reported already; the counters go on
    }
    std::string const text = fmt::format("stream {}, source {}: {}", streams_[i].name, source.to_string(),
                                         names_of(streams_[i].kind, findings));
    log::warning("first line: {}", text);
    run_.status.event(node_.time_base().seconds(now), node_.config().process, "first_line_alarm", text);
    publish_alarm(now);
}

void FirstLineReport::report(SimTime now) {
    auto out = row_.begin();
    for (std::size_t i = 0; i < streams_.size(); ++i) {
        Stream const& stream = streams_[i];
        for (std::uint64_t const count : stream.counters()) {
            *out++ = static_cast<double>(count);
        }
        *out++ = static_cast<double>(stream.refused());
        if (stream.kind == streams::Kind::smv) {
            *out++ = static_cast<double>(stream.contested());
        }
        if (auto const* counts = authenticity(stream.name)) {
            for (std::uint64_t const count : *counts) {
                *out++ = static_cast<double>(count);
            }
        }
        if (alarms_[i].settle()) {
            run_.status.event(node_.time_base().seconds(now), node_.config().process, "first_line_cleared",
                              fmt::format("stream {}", stream.name));
        }
    }
    publish_alarm(now);
    counters_->row(now, row_);
    counters_->flush();
    state_->flush();
}

} // namespace gridspace::gateways
