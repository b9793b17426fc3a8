// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/stream_watch.hpp"

#include "common/text.hpp"
#include "gateways/port/subscriptions.hpp"

#include <algorithm>

namespace gridspace::scan {
namespace {

/// What is refused is told apart from what is only reported; nothing is taken away from what is counted.
constexpr gateways::FirstLineConfig::OnFinding kRefuse = gateways::FirstLineConfig::OnFinding::refuse;

gateways::GooseFirstLine goose_rules(streams::Stream const* described, bool check_clock) {
    ids::GooseRuleParams const usual;
    gateways::FirstLineConfig config;
    config.on_finding = kRefuse;
    config.check_clock = check_clock;
    if (described == nullptr) {
        return {config, usual.min_time_ms, usual.max_time_ms, false, 0};
    }
    auto const& timing = described->timing;
    return {config, timing.min_time_ms, timing.max_time_ms, false,
            std::max(timing.live_factor * timing.max_time_ms, timing.live_min_ms)};
}

iec61850::SvSubscription subscription_of(SvDescription const& description) {
    auto out = gateways::sv_subscription(description.stream);
    out.sample_octets = 0; // the layout has its own say
    out.simulation = false;
    if (!description.rate_known) {
        out.wrap = 0;
    }
    return out;
}

} // namespace

void SenderWatch::see(iec61850::FrameHeader const& header, std::uint32_t conf_rev, bool simulated, Place at) {
    if (!started_) {
        started_ = true;
        source_ = header.source;
        conf_rev_ = conf_rev;
    }
    if (header.source != source_) {
        bool const is_known = foreign_.size() < kMostForeign || foreign_.contains(header.source);
        ++foreign_[is_known ? header.source : foreign_.rbegin()->first];
    }
    conf_rev_changes_ += conf_rev != conf_rev_ ? 1U : 0U;
    conf_rev_ = conf_rev;
    simulated_ += simulated ? 1U : 0U;
    last_ = at;
}

void SenderWatch::raise(std::string const& names, iec61850::FrameHeader const& header, Place at) {
    if (names.empty()) {
        return;
    }
    for (std::string const& name : split(names, ',')) {
        alarms_.raise(std::string{trim(name)}, at, "from " + header.source.to_string());
    }
}

void SenderWatch::finish(std::int64_t end_ns, bool alive) {
    if (started_ && !alive) {
        alarms_.raise("silent", last_,
                      fmt::format("nothing came for {:.3f} s", 1e-9 * static_cast<double>(end_ns - last_.time_ns)));
    }
}

void SenderWatch::report(StreamScan& out) const {
    out.foreign = foreign_;
    out.conf_rev_changes = conf_rev_changes_;
    out.simulated = simulated_;
    out.alarms.insert(out.alarms.end(), alarms_.all().begin(), alarms_.all().end());
}

SvWatch::SvWatch(SvDescription const& description, ForecastSettings const& settings, bool alone)
    : description_{description},
      first_line_{{.on_finding = kRefuse}, description.stream.rate_hz.to_double(), false, true},
      subscriber_{subscription_of(description)} {
    if (!description.phases) {
        why_not_ = description.layout;
        return;
    }
    if (auto reader = relay::SampleReader::create(description.stream, *description.phases)) {
        reader_ = std::move(*reader);
    }
    why_not_ = !settings.model ? "no model" : !description.rate_known ? "its rate is not known" : "";
    if (why_not_.empty() && alone) {
        forecast_.emplace(*settings.model, description.stream.rate_hz.to_double(), settings.nominal_peak_a);
    } else if (why_not_.empty()) {
        why_not_ = "as an end of the line";
    }
}

void SvWatch::take(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, std::size_t place, Place at) {
    if (place == 0 || sender_.last().frame != at.frame) {
        sender_.see(header, asdu.conf_rev, header.simulated(), at);
    }
    auto const verdict = first_line_.judge(header, asdu, place, at.time_ns);
    sender_.raise(ids::sv_finding_names(verdict.findings & ~gateways::kHarmlessSvFindings), header, at);
    if (verdict.contested) {
        sender_.raise("contested", header, at);
    }
    synch_changes_ += synch_ && *synch_ != asdu.smp_synch ? 1U : 0U;
    synch_ = asdu.smp_synch;
    lowest_synch_ = std::min(lowest_synch_, asdu.smp_synch);
    iec61850::SvArrival const arrival = subscriber_.receive(asdu.smp_cnt, at.time_ns);
    if (arrival.event == iec61850::SvEvent::restart) {
        sender_.raise_rule("smp_cnt_jump", at);
    }
    if (!reader_ || asdu.sample.size() != reader_->sample_octets()) {
        return;
    }
    relay::EndSample const sample = reader_->read(header, asdu);
    not_good_ += sample.validity != relay::Validity::good ? 1U : 0U;
    if (forecast_ && arrival.accepted) {
        forecast_->add(arrival.index, sample, at);
    }
}

void SvWatch::finish(std::int64_t end_ns, bool alive) {
    sender_.finish(end_ns, alive);
    if (forecast_) {
        forecast_->finish();
    }
}

void SvWatch::report(StreamScan& out) const {
    sender_.report(out);
    out.layout = description_.layout;
    out.readable = reader_.has_value();
    out.gaps = subscriber_.counters().of(iec61850::SvEvent::lost);
    out.jumps = subscriber_.counters().of(iec61850::SvEvent::restart);
    out.synch_changes = synch_changes_;
    out.lowest_synch = lowest_synch_;
    out.not_good = not_good_;
    out.forecast.why_not = why_not_;
    if (forecast_) {
        out.forecast = forecast_->result();
        if (out.forecast.why_not.empty()) {
            auto const& own = forecast_->alarms().all();
            out.alarms.insert(out.alarms.end(), own.begin(), own.end());
        }
    }
}

GooseWatch::GooseWatch(streams::Stream const* described, bool check_clock)
    : first_line_{goose_rules(described, check_clock)} {}

void GooseWatch::take(iec61850::GooseFrame const& message, Place at) {
    sender_.see(message.header, message.conf_rev, message.simulated(), at);
    if (at.time_ns > live_until_ns_) {
        sender_.raise("time_to_live", message.header, at);
        first_line_.expired();
        live_until_ns_ = INT64_MAX;
    }
    auto const verdict = first_line_.judge(message, at.time_ns);
    sender_.raise(ids::goose_finding_names(verdict.findings), message.header, at);
    if (verdict.use) {
        live_until_ns_ = at.time_ns + std::int64_t{message.live_ms} * 1'000'000;
    }
}

} // namespace gridspace::scan
