// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/evaluation/attack_catalogue.hpp"

#include <cmath>

namespace gridspace::ids {

std::vector<CataloguedAttack> attack_catalogue(double nominal_peak_a, double rate_hz, double frequency_hz,
                                               std::int64_t start, std::int64_t length) {
    using Params = attacker::SampleAttackParams;
    using Kind = Params::Kind;
    auto const cycle = static_cast<std::int64_t>(std::lround(rate_hz / frequency_hz));
    std::vector<CataloguedAttack> out;
    auto add = [&](std::string name, Kind kind, auto set) -> CataloguedAttack& {
        Params p;
        p.name = name;
        p.kind = kind;
        p.channels = 7;
        p.from = start;
        p.until = start + length;
        p.rate_hz = rate_hz;
        p.frequency_hz = frequency_hz;
        set(p);
        out.push_back({std::move(name), p, false, {}});
        return out.back();
    };
    auto const random = [&](std::int64_t count) {
        return [&, count](Params& p) {
            p.channels = 1;
            p.until = start + count;
            p.low_a = -1.1 * nominal_peak_a;
            p.high_a = 1.1 * nominal_peak_a;
            p.min_error_a = 0.06 * nominal_peak_a;
        };
    };
    add("random_1", Kind::random, random(1));
    add("random_40", Kind::random, random(40));
    for (int const percent : {1, 3, 5, 20}) {
        add("bias_" + std::to_string(percent), Kind::bias,
            [&](Params& p) { p.bias_a = percent / 100.0 * nominal_peak_a; });
    }
    for (int const percent : {1, 3, 10, 100}) {
        add("scale_" + std::to_string(percent), Kind::scale, [&](Params& p) { p.factor = 1 + percent / 100.0; });
    }
    for (int const percent : {2, 10, 50}) {
        add("ramp_" + std::to_string(percent), Kind::ramp, [&](Params& p) { p.ramp_per_cycle = percent / 100.0; });
    }
    add("replay_in_phase", Kind::replay, [&](Params& p) { p.delay = 2 * cycle; });
    add("replay_out_of_phase", Kind::replay, [&](Params& p) { p.delay = 2 * cycle + cycle / 3; });
    add("freeze", Kind::freeze, [](Params&) {});
    auto const masquerade = [&](double pu) { return [&, pu](Params& p) { p.peak_a = pu * nominal_peak_a; }; };
    add("masquerade_0.5", Kind::masquerade, masquerade(0.5));
    add("masquerade_1", Kind::masquerade, masquerade(1));
    add("masquerade_5", Kind::masquerade, masquerade(5));
    CataloguedAttack& both = add("both_ends_5", Kind::masquerade, masquerade(5));
    both.both_ends = true;
    both.to = both.from;
    both.to.name += "_to";
    both.to.peak_a *= -0.6; // the far end feeds the pretended fault too: out of the line is negative
    return out;
}

} // namespace gridspace::ids
