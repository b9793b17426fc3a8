// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The models and training configurations that are shipped, on waveforms they were not made from.
#include "common/source_tree.hpp"
#include "ids/detector/detector_config.hpp"
#include "ids/evaluation/evaluate.hpp"
#include "ids/evaluation/protection_trial.hpp"
#include "ids/forecaster/model_file.hpp"
#include "ids/training/training_config.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace gridspace::ids {
namespace {

std::filesystem::path const kConfigs = source_tree("configs");

Model shipped(std::string const& name) {
    auto model = load_model(kConfigs / "models" / (name + ".json"));
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model.value_or(Model{});
}

/// Another nominal current, other loads and faults than in training.
std::vector<LineWaveform> strangers(std::uint64_t count) {
    SyntheticParams s;
    s.nominal_peak_a = 23;
    s.load = {0.5, 1.0};
    s.frequency_spread_hz = 0.3;
    s.harmonics_percent = 2;
    s.event_s = {0.2, 0.25};
    std::vector<LineWaveform> out;
    for (std::uint64_t n = 0; n < count; ++n) {
        out.push_back(synthesise(s, static_cast<Situation>(n % 10), 4242, n));
    }
    return out;
}

TEST(ShippedModels, LoadAndFitTheirConfigurations) {
    int configurations = 0;
    for (auto const& entry : std::filesystem::directory_iterator{kConfigs / "ids"}) {
        config::Diagnostics diagnostics;
        auto const config = load_training_config(entry.path(), diagnostics);
        ASSERT_TRUE(config) << diagnostics.render();
        Model const model = shipped(config->name);
        EXPECT_EQ(model.window, config->window) << config->name;
        EXPECT_EQ(model.channels, config->channels) << config->name;
        EXPECT_EQ(model.rate_hz, config->rate_hz) << config->name;
        ++configurations;
    }
    EXPECT_GE(configurations, 6);
}

TEST(ShippedModels, KeepTheirFalsePositivesOnStrangeWaveforms) {
    auto const recordings = strangers(20);
    for (char const* name : {"ar_20", "mlp_20_10_1"}) {
        EvaluationOptions o;
        o.nominal_peak_a = 23;
        o.threads = 1;
        Evaluation const e = evaluate(shipped(name), recordings, o);
        EXPECT_GE(e.quality.samples, 200'000U);
        EXPECT_LT(e.quality.before[3].percent, 0.4) << name; // 2 % of the larger peak
        EXPECT_EQ(e.quality.before[4].count, 0U) << name;    // adaptive
        EXPECT_GT(e.quality.before[0].percent, 5) << name;   // 2 % of the sample itself: ill-posed
        ASSERT_FALSE(e.attacks.empty());
        EXPECT_EQ(e.attacks[0].attack, "random_1");
        EXPECT_GE(e.attacks[0].seen.percent, 95) << name;
        EXPECT_EQ(e.attacks[0].median_delay_samples, 0) << name;
    }
}

TEST(ShippedModels, TheRecommendedDetectorPermitsFaultsAndWithholdsForgeries) {
    Model const model = shipped("ar_20");
    DetectorConfig config;
    config.nominal_peak_a = 23;
    config.on_unconfirmed = SupervisorParams::OnUnconfirmed::block;
    auto const detector = make_detector_params(config, model, 4800, 60);
    ASSERT_TRUE(detector);
    DetectorParams open = *detector;
    open.guard.mode = Mode::monitor;
    relay::RelayParams relay;
    relay.element.pickup_a = 0.3 * 23 / 1.4142;
    int faults = 0, permitted = 0, withheld = 0, forged = 0;
    for (LineWaveform const& w : strangers(20)) {
        if (is_internal_fault(w.situation)) {
            ++faults;
            std::int64_t const free = run_trial(model, open, relay, w, nullptr, 1).trip;
            permitted += free >= 0 && run_trial(model, *detector, relay, w, nullptr, 1).trip == free ? 1 : 0;
        } else if (w.situation == Situation::quiet) {
            EXPECT_EQ(run_trial(model, *detector, relay, w, nullptr, 1).trip, -1);
            for (CataloguedAttack const& a : attack_catalogue(23, 4800, 60, 1200, 900)) {
                bool const trips_unguarded = run_trial(model, open, relay, w, &a, 1).trip >= 0;
                bool const trips = run_trial(model, *detector, relay, w, &a, 1).trip >= 0;
                if (a.both_ends) {
                    EXPECT_TRUE(trips) << "no detector of currents can tell it from a fault";
                } else {
                    EXPECT_FALSE(trips) << a.name;
                    forged += trips_unguarded ? 1 : 0;
                    withheld += trips_unguarded && !trips ? 1 : 0;
                }
            }
        }
    }
    EXPECT_GE(permitted, faults / 2);
    EXPECT_GE(forged, 5);
    EXPECT_EQ(withheld, forged);
}

TEST(DetectorConfig, RefusesAModelOfAnotherRate) {
    DetectorConfig config;
    config.nominal_peak_a = 18;
    auto const r = make_detector_params(config, oscillator(4000, 50), 4800, 60);
    ASSERT_FALSE(r);
    EXPECT_NE(r.error().message.find("4000 samples a second, and the streams have 4800"), std::string::npos);
    config.nominal_peak_a = 0;
    EXPECT_FALSE(make_detector_params(config, oscillator(4800, 60), 4800, 60));
}

} // namespace
} // namespace gridspace::ids
