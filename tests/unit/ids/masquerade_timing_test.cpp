// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/evaluation/protection_trial.hpp"
#include "ids/forecaster/model_file.hpp"

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>

namespace gridspace::ids {
namespace {

/// Permission is given when the onset that both ends see and the first difference are within 2.5 ms of each other. The
/// onset is renewed for as long as both ends go on to be surprised: so a forgery that begins later than 2.5 ms after
/// the disturbance may still inherit it. For how long is measured here, and said in docs/design/ids.md.
TEST(MasqueradeTiming, AForgeryLongAfterADisturbanceInheritsNothing) {
    constexpr int kTimings = 1000;
    constexpr double kNominalPeakA = 10, kLongestMs = 20, kBinMs = 2.5;
    Model const model = *load_model(source_tree("configs/models/ar_20.json"));
    DetectorParams detector;
    detector.guard.threshold.nominal_peak_a = kNominalPeakA;
    detector.supervisor.on_unconfirmed = SupervisorParams::OnUnconfirmed::block;
    relay::RelayParams relay;
    relay.element.pickup_a = 0.3 * kNominalPeakA / std::sqrt(2.0);
    relay.element.slope_percent = 30;
    std::array<Situation, 4> const disturbances{Situation::load_step, Situation::line_trip, Situation::generator_trip,
                                                Situation::external_1ph};
    std::map<int, std::pair<int, int>> bins; ///< tripped, of
    double last_ms = -1;
    int early = 0;
    for (int k = 0; k < kTimings; ++k) {
        SyntheticParams grid;
        LineWaveform const w =
            synthesise(grid, disturbances[static_cast<std::size_t>(k) % 4], 31, static_cast<std::uint64_t>(k % 40));
        auto const offset = static_cast<std::int64_t>(kLongestMs * 4.8 * k / kTimings);
        CataloguedAttack attack;
        attack.from.name = "masquerade";
        attack.from.kind = attacker::SampleAttackParams::Kind::masquerade;
        attack.from.channels = 7;
        attack.from.from = w.event + offset;
        attack.from.until = attack.from.from + 1000;
        attack.from.peak_a = 5 * kNominalPeakA;
        bool const trips = run_trial(model, detector, relay, w, &attack, 1).trip >= attack.from.from;
        double const ms = static_cast<double>(offset) / 4.8;
        auto& [tripped, of] = bins[static_cast<int>(ms / kBinMs)];
        ++of;
        tripped += trips ? 1 : 0;
        early += trips && ms < kBinMs ? 1 : 0;
        last_ms = trips ? std::max(last_ms, ms) : last_ms;
    }
    for (auto const& [bin, counts] : bins) {
        std::printf("  %4.1f to %4.1f ms: %d of %d tripped\n", bin * kBinMs, (bin + 1) * kBinMs, counts.first,
                    counts.second);
    }
    std::printf("  last: %.2f ms\n", last_ms);
    EXPECT_GT(early, 10) << "the negative control: at once it is inherited";
    EXPECT_LT(last_ms, 12.5);
}

} // namespace
} // namespace gridspace::ids
