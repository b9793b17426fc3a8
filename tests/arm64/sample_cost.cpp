// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What one sample of a protected line costs a relay: detector (if a model is given), differential element, no frames
// and no DDS.
//   sample_cost PASSES [MODEL.json]
// Prints nanoseconds per sample of the fastest pass, on the steady clock. Under `qemu-system-aarch64 -icount shift=0` a
// nanosecond of that clock is one instruction (docs/reference/arm64.md).
#include "agents/relay/line_relay.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/detector/line_detector.hpp"
#include "ids/forecaster/model_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>
#include <optional>

using namespace gridspace;

int main(int argc, char** argv) {
    int const passes = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
    std::optional<ids::Model> model;
    if (argc > 2) {
        auto read = ids::load_model(argv[2]);
        if (!read) {
            fmt::print(stderr, "{}\n", describe(read.error()));
            return static_cast<int>(read.error().code);
        }
        model = std::move(*read);
    }
    ids::LineWaveform const wave = ids::synthesise({}, ids::Situation::internal_3ph, 1, 1);
    double best_ns = std::numeric_limits<double>::infinity();
    std::size_t trips = 0;
    for (int pass = 0; pass < passes; ++pass) {
        ids::DetectorParams settings;
        settings.guard.threshold.nominal_peak_a = 10;
        std::optional<ids::LineDetector> detector;
        if (model) {
            detector.emplace(*model, settings);
        }
        relay::RelayParams element;
        element.element.pickup_a = 2;
        relay::LineRelay relay{element};
        auto const begin = std::chrono::steady_clock::now();
        for (std::size_t k = 0; k < wave.size(); ++k) {
            auto const index = static_cast<std::int64_t>(k);
            relay::LineSample sample{index, {}, {}};
            sample.from.i_a = wave.from[k];
            sample.to.i_a = wave.to[k];
            sample.from.present = sample.to.present = true;
            if (detector) {
                ids::LineVerdict const& verdict =
                    detector->step(index, {wave.from[k], true}, {wave.to[k], true}, relay.output().pickup);
                sample.from.i_a = verdict.from_accepted_a;
                sample.to.i_a = verdict.to_accepted_a;
                relay.step(sample, {verdict.granted});
            } else {
                relay.step(sample, {});
            }
        }
        double const ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
        best_ns = std::min(best_ns, ns / static_cast<double>(wave.size()));
        trips += relay.output().trip ? 1U : 0U;
    }
    fmt::print("{:.0f} ns per sample, {} samples, {} of {} passes end tripped\n", best_ns, wave.size(), trips, passes);
    return 0;
}
