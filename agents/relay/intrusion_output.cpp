// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/intrusion_output.hpp"

#include "agents/relay/relay_declaration.hpp"
#include "common/log.hpp"
#include "common/wall_clock_file.hpp"

#include <fmt/format.h>

namespace gridspace::relay {

Result<std::unique_ptr<IntrusionOutput>> IntrusionOutput::create(bus::Node& node, DaemonRun& run,
                                                                 RelayConfig const& config, Rational rate_hz) {
    auto out = std::unique_ptr<IntrusionOutput>{new IntrusionOutput{node, run}};
    std::string const& process = node.config().process;
    if (!config.ids->verdicts.empty()) {
        auto writer = node.writer<IdsVerdict>(config.ids->verdicts);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        out->writer_ = std::move(*writer);
        for (Ref const* stream : {&config.from_stream, &config.to_stream}) {
            out->verdicts_.emplace_back(*out->writer_, process, stream->name, rate_hz);
        }
    }
    auto state = bus::SignalPublisher::create(node, "ids", detector_state_signals(config), {});
    if (!state) {
        return std::unexpected{state.error()};
    }
    out->state_ = std::move(*state);
    auto counters = bus::SignalPublisher::create(node, "ids_counters", detector_counter_signals(config), {});
    if (!counters) {
        return std::unexpected{counters.error()};
    }
    out->counters_ = std::move(*counters);
    return out;
}

void IntrusionOutput::announce(SimTime now) {
    state_->announce(now);
    counters_->announce(now);
}

void IntrusionOutput::sample(ids::LineDetector const& detector, std::int64_t index, std::int64_t sample_ns, SimTime now,
                             std::int64_t took_ns) {
    times_.add(took_ns);
    if (!verdicts_.empty()) {
        verdicts_[0].add(index, detector.from().verdict(), now, sample_ns);
        verdicts_[1].add(index, detector.to().verdict(), now, sample_ns);
    }
    publish_state(detector, now);
}

void IntrusionOutput::publish_state(ids::LineDetector const& detector, SimTime now) {
    ids::LineVerdict const& v = detector.verdict();
    std::array<bool, 2> const locked{detector.from().locked_out(), detector.to().locked_out()};
    if (alarms_ && *alarms_ == v.alarms && granted_ == v.granted && locked == locked_out_) {
        return;
    }
    bool const already_sent = alarms_ && *alarms_ == v.alarms;
    bool const silent = !alarms_ && v.alarms == 0;
    alarms_ = v.alarms;
    granted_ = v.granted;
    locked_out_ = locked;
    std::array<double, 5> const row{v.alarms != 0 ? 1.0 : 0.0, static_cast<double>(v.alarms), v.granted ? 1.0 : 0.0,
                                    locked[0] ? 1.0 : 0.0, locked[1] ? 1.0 : 0.0};
    state_->row(now, row);
    if (!already_sent && !silent) {
        tell(detector, now);
    }
}

/// An alarm that comes, changes or goes, as an event and in the log.
void IntrusionOutput::tell(ids::LineDetector const& detector, SimTime now) {
    ids::LineVerdict const& v = detector.verdict();
    std::string text = v.alarms == 0 ? "none" : ids::alarm_names(v.alarms);
    for (auto const& [end, guard] : {std::pair{"from", &detector.from()}, std::pair{"to", &detector.to()}}) {
        for (std::size_t p = 0; p < 3; ++p) {
            ids::ChannelVerdict const& c = guard->verdict().phases[p];
            if (c.flagged) {
                text += fmt::format("; sample {} phase {} of the `{}` end: {:.2f} A, forecast {:.2f} A", v.index,
                                    "abc"[p], end, c.raw_a, c.forecast_a);
            }
        }
    }
    std::string_view const kind = v.alarms == 0 ? "alarm_cleared" : "alarm";
    // One event per isolated fake would be hundreds a run: the log has them all, the run's events the first, and those
    // that mean more.
    constexpr ids::Alarms kSerious =
        ids::kOneEnd | ids::kUnconfirmed | ids::kNoise | ids::kLockedOut | ids::kNotArmed | ids::kMeasuringChain;
    bool const first = v.alarms != 0 && !any_told_;
    any_told_ = any_told_ || first;
    if (first || (v.alarms & kSerious) != 0) {
        log::warning("ids: {}: {}", kind, text);
        run_.status.event(node_.time_base().seconds(now), node_.config().process, "ids_alarm", text);
    } else {
        log::info("ids: {}: {}", kind, text);
    }
}

void IntrusionOutput::report(ids::LineDetector const& detector, SimTime now) {
    std::vector<double> row{static_cast<double>(detector.alarms())};
    for (ids::StreamGuard const* guard : {&detector.from(), &detector.to()}) {
        ids::GuardCounters const& c = guard->counters();
        for (std::uint64_t const n :
             {c.samples, c.flagged, c.open_flagged, c.replaced, c.filled, c.restarts, c.unusable}) {
            row.push_back(static_cast<double>(n));
        }
        row.push_back(guard->sigma_percent());
    }
    counters_->row(now, row);
}

void IntrusionOutput::flush(SimTime now, bool final) {
    counters_->flush();
    if (final) {
        for (VerdictPublisher& v : verdicts_) {
            v.flush(now);
        }
        write_times();
    }
}

void IntrusionOutput::write_times() const {
    if (times_.count() == 0) {
        return;
    }
    double const p50 = times_.percentile_us(0.5), p99 = times_.percentile_us(0.99);
    log::info("ids: {} samples of both streams; {:.1f} us a sample in the median, p99 {:.1f} us, longest {:.1f} us",
              times_.count(), p50, p99, times_.longest_us());
    std::string const& process = node_.config().process;
    write_wall_clock(process, {{"ids." + process + ".time_us_", &times_}});
}

} // namespace gridspace::relay
