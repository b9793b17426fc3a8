// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The path of a sample through detector and relay does not touch the heap. A program of its own, because it replaces
// operator new.
#include "agents/attacker/sample_attack.hpp"
#include "agents/relay/line_relay.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/detector/line_detector.hpp"
#include "tests/support/allocations.hpp"

#include <gtest/gtest.h>
#include <memory>
#include <string>

namespace gridspace::ids {
namespace {

TEST(HotPath, DetectorRelayAndAttackDoNotAllocatePerSample) {
    for (auto const situation : {Situation::quiet, Situation::internal_3ph}) {
        for (Mode const mode : {Mode::paper, Mode::hold_off, Mode::supervise, Mode::monitor}) {
            LineWaveform const w = synthesise({}, situation, 1, 1);
            DetectorParams p;
            p.guard.mode = mode;
            p.guard.threshold.nominal_peak_a = 10;
            LineDetector detector{oscillator(4800, 60), p};
            relay::RelayParams r;
            r.element.pickup_a = 2;
            relay::LineRelay relay{r};
            attacker::SampleAttackParams a;
            a.name = "replay";
            a.kind = attacker::SampleAttackParams::Kind::replay;
            a.from = 500;
            a.until = 800;
            attacker::SampleAttack attack = *attacker::SampleAttack::create(a, 1);
            std::size_t const before = allocations();
            for (std::size_t k = 0; k < w.size(); ++k) {
                auto const index = static_cast<std::int64_t>(k);
                LineVerdict const& v = detector.step(index, {attack.apply(index, w.from[k]).sent_a, k % 97 != 0},
                                                     {w.to[k], true}, relay.output().pickup);
                relay::LineSample s{index, {}, {}};
                s.from.i_a = v.from_accepted_a;
                s.to.i_a = v.to_accepted_a;
                s.from.present = k % 97 != 0;
                s.to.present = true;
                relay.step(s, {v.granted});
            }
            EXPECT_EQ(allocations() - before, 0U) << static_cast<int>(mode);
        }
    }
    EXPECT_GT(allocations_of([] { auto const p = std::make_unique<std::string>(100, 'x'); }), 0U); // the counter counts
}

} // namespace
} // namespace gridspace::ids
