// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/line_relay.hpp"
#include "ids/detector/line_detector.hpp"

#include <optional>

namespace gridspace::relay {

/// A line relay, and the intrusion detector in front of it if it has one. The detector sees a sample first and knows
/// what the relay's element said about the sample before; the relay gets what the detector accepted, and its
/// permission. Pure; no allocation per sample.
class GuardedRelay {
  public:
    explicit GuardedRelay(RelayParams const& params) : relay_{params} {}
    /// `model` must have passed ids::check(); the polarity of the detector is taken from `params`.
    GuardedRelay(RelayParams const& params, ids::Model const& model, ids::DetectorParams detector) : relay_{params} {
        detector.along_the_line = params.to_positive == Positive::from_to;
        detector_.emplace(model, detector);
    }

    RelayOutput const& step(LineSample const& sample) {
        if (!detector_) {
            return relay_.step(sample);
        }
        judge(sample);
        return decide(sample);
    }
    /// The two halves of step(), for who measures the time of the first. Only with a detector.
    ids::LineVerdict const& judge(LineSample const& sample) {
        RelayParams const& p = relay_.params();
        return detector_->step(sample.index, {sample.from.i_a, usable(sample.from, p)},
                               {sample.to.i_a, usable(sample.to, p)}, relay_.output().pickup);
    }
    RelayOutput const& decide(LineSample const& sample) {
        ids::LineVerdict const& verdict = detector_->verdict();
        LineSample accepted = sample;
        accepted.from.i_a = verdict.from_accepted_a;
        accepted.to.i_a = verdict.to_accepted_a;
        return relay_.step(accepted, {verdict.granted});
    }

    [[nodiscard]] LineRelay& relay() { return relay_; }
    [[nodiscard]] LineRelay const& relay() const { return relay_; }
    [[nodiscard]] ids::LineDetector const* detector() const { return detector_ ? &*detector_ : nullptr; }

  private:
    LineRelay relay_;
    std::optional<ids::LineDetector> detector_;
};

} // namespace gridspace::relay
