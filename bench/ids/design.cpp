// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bench/ids/design.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace {

Result<std::vector<Design>> designs(std::filesystem::path const& models, double nominal_peak_a) {
    auto const mlp = ids::load_model(models / "mlp_20_10_1.json"), ar = ids::load_model(models / "ar_20.json");
    if (!mlp || !ar) {
        return std::unexpected{!mlp ? mlp.error() : ar.error()};
    }
    using Of = ids::ThresholdParams::Of;
    std::vector<Design> out;
    auto add = [&](std::string name, ids::Model const& model, ids::Mode mode, Of of) -> ids::DetectorConfig& {
        out.push_back({std::move(name), model, {}});
        out.back().config.mode = mode;
        out.back().config.of = of;
        out.back().config.nominal_peak_a = nominal_peak_a;
        return out.back().config;
    };
    add("no detector", *ar, ids::Mode::monitor, Of::larger_peak);
    add("paper, 20-10-1", *mlp, ids::Mode::paper, Of::nominal_peak);
    add("paper, AR(20)", *ar, ids::Mode::paper, Of::nominal_peak);
    for (std::int64_t const k : {1, 8, 19}) {
        add(fmt::format("hold-off {}", k), *ar, ids::Mode::hold_off, Of::larger_peak).hold_off_samples = k;
    }
    add("supervise, fixed 2 %", *ar, ids::Mode::supervise, Of::larger_peak).on_unconfirmed =
        ids::SupervisorParams::OnUnconfirmed::block;
    add("supervise, block", *ar, ids::Mode::supervise, Of::adaptive).on_unconfirmed =
        ids::SupervisorParams::OnUnconfirmed::block;
    add("supervise, delay", *ar, ids::Mode::supervise, Of::adaptive);
    return out;
}

relay::RelayParams relay_params(relay::ElementParams::Kind kind, ids::TrainingConfig const& config) {
    relay::RelayParams p;
    double const nominal_rms = config.simulated->nominal_peak_a / std::sqrt(2.0);
    int const cycle = static_cast<int>(std::lround(config.rate_hz / config.frequency_hz));
    p.element.kind = kind;
    p.element.samples_per_cycle = p.element.window_samples = cycle;
    p.element.pickup_a = kind == relay::ElementParams::Kind::rms ? nominal_rms / 2 : 0.3 * nominal_rms;
    p.element.slope_percent = 30;
    return p;
}

} // namespace gridspace
