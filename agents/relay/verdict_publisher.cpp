// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/verdict_publisher.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::relay {
namespace {

PhaseVerdict phase_of(ids::ChannelVerdict const& v, bool judged) {
    PhaseVerdict out;
    out.raw_a(static_cast<float>(v.raw_a));
    out.forecast_a(static_cast<float>(v.forecast_a));
    out.accepted_a(static_cast<float>(v.accepted_a));
    out.limit_a(static_cast<float>(v.limit_a));
    out.open_forecast_a(static_cast<float>(v.open_forecast_a));
    out.flags(static_cast<std::uint8_t>((judged ? VERDICT_JUDGED : 0U) | (v.flagged ? VERDICT_FLAGGED : 0U) |
                                        (v.open_flagged ? VERDICT_OPEN_FLAGGED : 0U)));
    return out;
}

} // namespace

VerdictPublisher::VerdictPublisher(bus::Writer<IdsVerdict>& writer, std::string const& detector,
                                   std::string const& stream, Rational rate_hz)
    : writer_{&writer},
      per_message_{std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(rate_hz.to_double() / 100)), 1,
                                           MAX_VERDICTS_PER_MESSAGE)},
      message_{std::make_unique<IdsVerdict>()} {
    message_->detector(detector.c_str());
    message_->stream(stream.c_str());
    message_->rate_num(static_cast<std::uint32_t>(rate_hz.num()));
    message_->rate_den(static_cast<std::uint32_t>(rate_hz.den()));
    message_->samples().reserve(per_message_);
}

void VerdictPublisher::add(std::int64_t index, ids::StreamVerdict const& verdict, SimTime now, std::int64_t time_ns) {
    if (!message_->samples().empty() && index != next_index_) {
        flush(now);
    }
    if (message_->samples().empty()) {
        message_->first_index(static_cast<std::uint64_t>(std::max<std::int64_t>(index, 0)));
    }
    SampleVerdict sample;
    sample.a(phase_of(verdict.phases[0], verdict.ready));
    sample.b(phase_of(verdict.phases[1], verdict.ready));
    sample.c(phase_of(verdict.phases[2], verdict.ready));
    message_->samples().push_back(sample);
    message_->time_ns(time_ns);
    next_index_ = index + 1;
    if (message_->samples().size() >= per_message_) {
        flush(now);
    }
}

void VerdictPublisher::flush(SimTime now) {
    if (!message_->samples().empty()) {
        writer_->write(*message_, now);
        message_->samples().clear();
    }
}

} // namespace gridspace::relay
