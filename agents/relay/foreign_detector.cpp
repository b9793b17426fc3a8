// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/foreign_detector.hpp"

#include <cmath>
#include <utility>

namespace gridspace::relay {

ForeignDetector::ForeignDetector(RelayConfig const& config, ForeignPermissionParams const& params)
    : streams_{config.from_stream.name, config.to_stream.name}, permission_{params} {}

Result<std::unique_ptr<ForeignDetector>> ForeignDetector::create(bus::Node& node, RelayConfig const& config,
                                                                 double rate_hz) {
    ForeignDetectorConfig const& own = *config.foreign_detector;
    auto const samples = [&](double ms) { return std::max(static_cast<int>(std::ceil(ms / 1e3 * rate_hz - 1e-9)), 1); };
    ForeignPermissionParams const params{samples(own.wait_ms), samples(own.hold_ms), samples(own.delay_ms),
                                         own.on_flagged == ForeignDetectorConfig::OnFlagged::delay,
                                         own.unheard == ForeignDetectorConfig::Unheard::trip};
    std::unique_ptr<ForeignDetector> out{new ForeignDetector{config, params}};
    out->rate_hz_ = rate_hz;
    auto reader = node.reader<IdsVerdict>(own.verdicts);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    out->reader_ = std::move(*reader);
    return out;
}

void ForeignDetector::take(IdsVerdict const& verdict) {
    for (std::size_t end = 0; end < streams_.size(); ++end) {
        if (verdict.stream().c_str() != streams_[end]) {
            continue;
        }
        detector_ = verdict.detector().c_str();
        auto index = static_cast<std::int64_t>(verdict.first_index());
        for (SampleVerdict const& sample : verdict.samples()) {
            bool flagged = false;
            for (PhaseVerdict const* phase : {&sample.a(), &sample.b(), &sample.c()}) {
                flagged = flagged || (phase->flags() & VERDICT_FLAGGED) != 0;
            }
            permission_.verdict(end, index++, flagged);
        }
    }
}

bool ForeignDetector::step(std::int64_t index, bool picked_up, SimTime now) {
    for (auto& received : reader_->take()) {
        waiting_.push_back(std::move(received));
    }
    while (!waiting_.empty() && waiting_.front().origin.time <= now) {
        take(waiting_.front().value);
        waiting_.pop_front();
    }
    return permission_.step(index, picked_up);
}

} // namespace gridspace::relay
