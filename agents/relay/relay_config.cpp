// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_config.hpp"

namespace gridspace::relay {

void describe(config::Fields& f, RelayLogicConfig& config) {
    using Kind = ElementParams::Kind;
    using SealIn = RelayLogicConfig::SealIn;
    f.object("element", {.doc = "the differential element of a line"}, [&](config::Fields& e) {
        e.choice<Kind>("kind", config.kind, {{"phasor", Kind::phasor}, {"rms", Kind::rms}},
                       {.doc = "phasor: full-cycle DFT with restraint; rms: Eq. (5)-(6) as published"});
        e.fraction("window_cycles", config.window_cycles,
                   {.doc = "length of the sliding window", .max = 10, .above = 0});
        e.number("pickup_a", config.pickup_a,
                 {.doc = "RMS difference that picks up, primary", .required = true, .above = 0});
        e.number("slope_percent", config.slope_percent,
                 {.doc = "phasor: of the mean of the two currents", .min = 0, .max = 200});
        e.number("slope2_percent", config.slope2_percent,
                 {.doc = "phasor: above slope2_from_a; 0: none", .min = 0, .max = 200});
        e.number("slope2_from_a", config.slope2_from_a,
                 {.doc = "phasor: mean current where the second slope starts", .min = 0});
        e.integer("confirm_samples", config.confirm_samples,
                  {.doc = "samples in a row above pickup before the trip", .min = 1, .max = 1000});
        e.flag("publish_values", config.publish_values,
               {.doc = "differential, restraint and operating current of each sample as signals"});
        if (config.kind == Kind::rms && (e.has("slope_percent") || e.has("slope2_percent") || e.has("slope2_from_a"))) {
            e.error("slope_percent", "the element 'rms' has no restraint", "use kind: phasor, or leave the slope out");
        }
        if (config.slope2_percent > 0 && !(config.slope2_from_a > 0)) {
            e.error("slope2_percent", "it needs slope2_from_a");
        }
    });
    f.choice<SealIn>("seal_in", config.seal_in,
                     {{"until_reset", SealIn::until_reset}, {"while_pickup", SealIn::while_pickup}},
                     {.doc = "how long a trip stays"});
    f.flag("in_service", config.in_service, {.doc = "false: measures, never trips"});
    f.object("blocking", {.doc = "which samples are not trusted"}, [&](config::Fields& b) {
        b.integer(
            "max_interpolated", config.max_interpolated,
            {.doc = "missing samples in a row that are bridged; more block for a whole window", .min = 0, .max = 8});
        b.flag("accept_questionable", config.accept_questionable, {.doc = "use samples of questionable quality"});
        b.flag("test_mode", config.test_mode, {.doc = "use samples marked test or simulated"});
        b.choice<Synch>("required_synch", config.required_synch,
                        {{"global", Synch::global}, {"local", Synch::local}, {"none", Synch::none}},
                        {.doc = "least synchronisation of both streams"});
    });
}

Result<RelayParams> make_params(RelayLogicConfig const& config, Rational rate_hz, Rational frequency_hz) {
    auto const cycle = whole_samples(rate_hz, frequency_hz, 1);
    if (!cycle) {
        return std::unexpected{cycle.error()};
    }
    auto const window = whole_samples(rate_hz, frequency_hz, config.window_cycles);
    if (!window) {
        return std::unexpected{window.error()};
    }
    if (config.kind == ElementParams::Kind::phasor && !(config.window_cycles * Rational{2}).is_whole()) {
        return fail(ExitCode::usage,
                    "window_cycles " + config.window_cycles.to_string() +
                        " of a phasor element is not a multiple of 1/2",
                    "a DFT over a broken half cycle does not reject the DC offset");
    }
    RelayParams out;
    out.element = {config.kind,         *cycle, *window, config.pickup_a, config.slope_percent, config.slope2_percent,
                   config.slope2_from_a};
    out.confirm_samples = static_cast<int>(config.confirm_samples);
    out.seal_in = config.seal_in == RelayLogicConfig::SealIn::until_reset;
    out.max_interpolated = static_cast<int>(config.max_interpolated);
    out.accept_questionable = config.accept_questionable;
    out.required_synch = config.required_synch;
    out.test_mode = config.test_mode;
    out.in_service = config.in_service;
    return out;
}

} // namespace gridspace::relay
