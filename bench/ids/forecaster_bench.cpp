// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a forecast costs for one sample of three phases, compared with a plain loop over 20 samples of one phase (a
// linear forecast). `phases`: divide by it.
#include "common/source_tree.hpp"
#include "ids/forecaster/forecaster.hpp"
#include "ids/forecaster/model_file.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <string>
#include <vector>

namespace gridspace::ids {
namespace {

constexpr std::size_t kSamples = 4096;

std::vector<double> wave(std::size_t samples) {
    std::vector<double> out(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        out[i] = 10 * std::sin(0.0785 * static_cast<double>(i));
    }
    return out;
}

void forecast(benchmark::State& state, std::string const& name) {
    auto const model = load_model(source_tree("configs/models/" + name + ".json"));
    if (!model) {
        state.SkipWithError(model.error().message.c_str());
        return;
    }
    Forecaster<double> sut{*model};
    constexpr std::size_t kPhases = 3;
    std::vector<double> const history = wave(kSamples + static_cast<std::size_t>(sut.window()) * kPhases);
    std::vector<double> next(kPhases);
    std::size_t at = 0;
    for ([[maybe_unused]] auto const& one : state) {
        sut.forecast_phases(history.data() + at, next.data());
        benchmark::DoNotOptimize(next.data());
        at = (at + 1) % kSamples;
    }
    state.counters["phases"] = kPhases;
}

void plain_loop(benchmark::State& state) {
    constexpr std::size_t kTaps = 20;
    std::vector<double> const history = wave(kSamples + kTaps), taps = wave(kTaps);
    std::size_t at = 0;
    for ([[maybe_unused]] auto const& one : state) {
        double sum = 0;
        for (std::size_t k = 0; k < kTaps; ++k) {
            sum += taps[k] * history[at + k];
        }
        benchmark::DoNotOptimize(sum);
        at = (at + 1) % kSamples;
    }
    state.counters["phases"] = 1;
}

} // namespace
} // namespace gridspace::ids

int main(int argc, char** argv) {
    for (char const* name : {"ar_20", "mlp_20_10_1", "joint_20"}) {
        benchmark::RegisterBenchmark(name, gridspace::ids::forecast, std::string{name});
    }
    benchmark::RegisterBenchmark("plain_loop", gridspace::ids::plain_loop);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
