// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/evaluation/protection_trial.hpp"

#include <cassert>
#include <optional>

namespace gridspace::ids {

TrialOutcome run_trial(Model const& model, DetectorParams const& detector_params,
                       relay::RelayParams const& relay_params, LineWaveform const& w, CataloguedAttack const* attack,
                       std::uint64_t seed) {
    LineDetector detector{model, detector_params};
    relay::LineRelay relay{relay_params};
    std::optional<attacker::SampleAttack> from, to;
    if (attack != nullptr) {
        auto made = attacker::SampleAttack::create(attack->from, seed);
        assert(made);
        from = std::move(*made);
        if (attack->both_ends) {
            auto second = attacker::SampleAttack::create(attack->to, seed);
            assert(second);
            to = std::move(*second);
        }
    }
    TrialOutcome out;
    for (std::size_t k = 0; k < w.size(); ++k) {
        auto const index = static_cast<std::int64_t>(k);
        Abc const i_from = from ? from->apply(index, w.from[k]).sent_a : w.from[k];
        Abc const i_to = to ? to->apply(index, w.to[k]).sent_a : w.to[k];
        LineVerdict const& v = detector.step(index, {i_from, true}, {i_to, true}, relay.output().pickup);
        bool const counts = attack == nullptr || index >= attack->from.from;
        out.alarm = out.alarm < 0 && counts && (v.alarms & ~static_cast<Alarms>(kNoise)) != 0 ? index : out.alarm;
        relay::LineSample sample{index, {}, {}};
        sample.from.i_a = v.from_accepted_a;
        sample.to.i_a = v.to_accepted_a;
        sample.from.present = sample.to.present = true;
        relay::RelayOutput const& r = relay.step(sample, {v.granted});
        out.trip = r.trip && out.trip < 0 ? index : out.trip;
        out.pickup = r.pickup && out.pickup < 0 ? index : out.pickup;
    }
    out.alarms = detector.alarms();
    out.locked_out = detector.from().locked_out() || detector.to().locked_out();
    return out;
}

} // namespace gridspace::ids
