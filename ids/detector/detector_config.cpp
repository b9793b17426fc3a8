// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/detector/detector_config.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::ids {

void describe(config::Fields& f, DetectorConfig& config) {
    using Of = ThresholdParams::Of;
    using OnUnconfirmed = SupervisorParams::OnUnconfirmed;
    using Guard = DetectorConfig::Guard;
    f.choice<Mode>("mode", config.mode,
                   {{"supervise", Mode::supervise},
                    {"paper", Mode::paper},
                    {"hold_off", Mode::hold_off},
                    {"monitor", Mode::monitor}},
                   {.doc = "supervise: samples pass, a trip needs evidence from both ends; paper: rejected samples are "
                           "replaced, as published; "
                           "hold_off: replaced for a while; monitor: flags only"});
    f.file("model", config.model, {.doc = "forecaster (JSON, from `gridspace ids train`)", .required = true});
    f.object("threshold", {.doc = "how far a sample may be from its forecast"}, [&](config::Fields& t) {
        t.choice<Of>("of", config.of,
                     {{"adaptive", Of::adaptive},
                      {"nominal_peak", Of::nominal_peak},
                      {"running_peak", Of::running_peak},
                      {"larger_peak", Of::larger_peak},
                      {"instantaneous", Of::instantaneous}},
                     {.doc = "what the percentage is of; adaptive: of the larger peak, raised with the noise"});
        t.number("percent", config.percent, {.doc = "of it", .max = 100, .above = 0});
        t.number("nominal_peak_a", config.nominal_peak_a, {.doc = "crest of the nominal current", .above = 0});
        t.number("sigmas", config.sigmas,
                 {.doc = "adaptive: standard deviations of the forecast error", .min = 1, .max = 20});
        t.number("ceiling_percent", config.ceiling_percent, {.doc = "adaptive: never above", .max = 100, .above = 0});
        if (config.of != Of::instantaneous && config.of != Of::running_peak && !(config.nominal_peak_a > 0)) {
            t.error("nominal_peak_a", "this threshold needs it",
                    "the crest value of the nominal current: 1.414 times its RMS");
        }
    });
    if (!f.has("threshold")) {
        f.error("threshold", "it is missing", "e.g. threshold: {nominal_peak_a: 18}");
    }
    f.integer("hold_off_samples", config.hold_off_samples,
              {.doc = "hold_off: samples in a row that are replaced", .min = 1, .max = 1000});
    f.object("supervise", {.doc = "the mode supervise"}, [&](config::Fields& s) {
        s.choice<OnUnconfirmed>("on_unconfirmed", config.on_unconfirmed,
                                {{"delay", OnUnconfirmed::delay}, {"block", OnUnconfirmed::block}},
                                {.doc = "a pickup without evidence from both ends trips after delay_ms, or never"});
        s.number("delay_ms", config.delay_ms, {.doc = "how long such a pickup has to last", .min = 0, .max = 1000});
        s.number("kirchhoff_percent", config.kirchhoff_percent,
                 {.doc = "difference of the two ends that counts, of the larger peak", .max = 100, .above = 0});
        s.number(
            "class_percent", config.class_percent,
            {.doc = "standing difference that the measuring chain may make, of the larger peak", .min = 0, .max = 30});
    });
    f.choice<Guard>("guard", config.guard, {{"both", Guard::both}, {"from", Guard::from}, {"to", Guard::to}},
                    {.doc = "paper, hold_off: the streams whose samples are replaced"});
    f.text("verdicts", config.verdicts, {.doc = "DDS topic for the verdict on each sample; left out: none"});
}

Result<DetectorParams> make_detector_params(DetectorConfig const& config, Model const& model, double rate_hz,
                                            double frequency_hz) {
    if (std::fabs(model.rate_hz - rate_hz) > 1e-6 * rate_hz) {
        return fail(ExitCode::usage,
                    fmt::format("the model '{}' was made for {} samples a second, and the streams have {}", model.name,
                                model.rate_hz, rate_hz),
                    "train one for this rate");
    }
    if (std::fabs(model.frequency_hz - frequency_hz) > 1) {
        return fail(ExitCode::usage,
                    fmt::format("the model '{}' was made for {} Hz, and the network has {} Hz", model.name,
                                model.frequency_hz, frequency_hz),
                    "train one for this frequency");
    }
    using Of = ThresholdParams::Of;
    if (config.of != Of::instantaneous && config.of != Of::running_peak && !(config.nominal_peak_a > 0)) {
        return fail(ExitCode::usage, "the detector's threshold needs nominal_peak_a");
    }
    auto const cycles = [&](double n) { return static_cast<int>(std::lround(n * rate_hz / frequency_hz)); };
    auto const seconds = [&](double s) { return static_cast<int>(std::ceil(s * rate_hz - 1e-9)); };
    DetectorParams out;
    ThresholdParams& t = out.guard.threshold;
    t = {config.of,     config.percent,         config.nominal_peak_a, cycles(1),
         config.sigmas, config.ceiling_percent, seconds(0.1)};
    out.guard.mode = config.mode;
    out.guard.hold_off_samples = static_cast<int>(config.hold_off_samples);
    SupervisorParams& s = out.supervisor;
    s.on_unconfirmed = config.on_unconfirmed;
    s.delay_samples = std::max(seconds(config.delay_ms / 1e3), 1);
    s.kirchhoff_percent = config.kirchhoff_percent;
    s.both_ends_within = std::max(seconds(0.00125), 2);
    s.synchronous_within = std::max(seconds(0.0025), 4);
    s.kirchhoff_clean = cycles(0.5);
    s.armed_within = seconds(0.1);
    s.hold_samples = cycles(2);
    out.standing.cycle = cycles(1);
    out.standing.class_percent = config.class_percent;
    // A fixed threshold flags noise now and then, so that one flag is no evidence.
    s.weak_end_count = config.of == Of::adaptive ? 1 : s.burst_count;
    out.guard_from = config.guard != DetectorConfig::Guard::to;
    out.guard_to = config.guard != DetectorConfig::Guard::from;
    return out;
}

} // namespace gridspace::ids
