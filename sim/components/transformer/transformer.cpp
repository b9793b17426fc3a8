// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/transformer/transformer.hpp"

#include "common/text.hpp"
#include "sim/components/bus/bus.hpp"
#include "sim/components/faces/shared_checks.hpp"

#include <cmath>
#include <fmt/format.h>

/// Keys of a transformer, and its sequences. By phase: transformer_phases.cpp.
namespace gridspace::sim {

using namespace elements;

void Transformer::fields(Fields& f) {
    f.number("rating_kva", rating_kva, positive("rated power", true));
    f.number("r_percent", r_percent, not_negative("short-circuit resistance, of the rating"));
    f.number("x_percent", x_percent, not_negative("short-circuit reactance, of the rating", true));
    f.number("tap_ratio", tap_ratio, positive("off-nominal ratio at the first winding"));
    f.number("phase_shift_deg", phase_shift_deg, any("the second winding lags by it"));
    auto const winding = [&](std::string_view key, Winding& w, std::string_view doc) {
        f.choice<Winding>(key, w,
                          {{"wye_grounded", Winding::wye_grounded}, {"wye", Winding::wye}, {"delta", Winding::delta}},
                          {.doc = doc});
    };
    winding("from_winding", from_winding, "connection of the first winding");
    winding("to_winding", to_winding, "connection of the second winding");
    f.number("magnetising_percent", magnetising_percent, percent("magnetising current, of the rated current"));
    f.number("charging_percent", charging_percent, any("shunt susceptance, half at each winding, of the rating"));
    f.object("saturation", {.doc = "two-slope saturation of the core"}, [&](Fields& s) {
        Saturation& core = saturation.emplace();
        s.number("knee_pu", core.knee_pu, positive("flux linkage at the knee"));
        s.number("air_core_percent", core.air_core_percent, positive("reactance above the knee, of the rating"));
        if (magnetising_percent == 0) {
            s.error("", fmt::format("transformer '{}' saturates but has no magnetising current", name.name),
                    "give magnetising_percent");
        }
    });
    f.object("tap_changer", {.doc = "on load, with its voltage regulator"}, [&](Fields& t) {
        TapChanger& changer = tap_changer.emplace();
        changer.fields(t);
        changer.neutral_ratio = tap_ratio;
        tap_ratio = changer.ratio(changer.position);
        if (saturation) {
            t.error("", fmt::format("transformer '{}' saturates, and its ratio cannot change in a run", name.name),
                    "leave out `saturation` or `tap_changer`");
        }
    });
}

void Transformer::check(ElementCheck& check) const {
    if (tap_changer && !tap_changer->bus.empty()) {
        check.exists(Bus::kKind, tap_changer->bus);
    }
    double const percent = std::hypot(r_percent, x_percent), base_kva = check.around().base_kva();
    if (r_percent == 0 && x_percent == 0) {
        check.wrong("has no short-circuit impedance",
                    "give x_percent; an ideal transformer has no current that could be computed");
    } else if (percent / 100 * base_kva < kMinImpedancePu * rating_kva) {
        check.wrong(fmt::format("has {} %, too little to compute its current", shortest(percent)),
                    fmt::format("give it at least {:.2g} %", 100 * kMinImpedancePu * rating_kva / base_kva));
    }
}

Result<void> Transformer::check_windings() const {
    double const natural = (from_winding == Winding::delta) == (to_winding == Winding::delta) ? 0 : 30;
    if (std::abs(std::abs(phase_shift_deg) - natural) <= 1e-6) {
        return {};
    }
    return fail(
        ExitCode::usage,
        fmt::format("transformer '{}' cannot shift by {} degrees with its windings", name.name, phase_shift_deg),
        natural == 0 ? "two stars or two deltas have phase_shift_deg: 0"
                     : "a star and a delta have phase_shift_deg: 30 or -30");
}

Admittances Transformer::admittances(Surroundings const& around, Ends closed) const {
    double const to_system = around.base_kva() / rating_kva;
    Complex const series = 100.0 / (to_system * Complex{r_percent, x_percent});
    Complex const half{0, charging_percent / 200 / to_system};
    Complex const magnetising{0, -magnetising_percent / 100 / to_system};
    Complex const tap = std::polar(tap_ratio, phase_shift_deg * std::numbers::pi / 180);
    Admittances y;
    y.tt = series + half;
    y.ff = (series + half + magnetising) / std::norm(tap);
    y.ft = -series / std::conj(tap);
    y.tf = -series / tap;
    return seen_from(y, closed);
}

Admittances Transformer::sequence(Sequence sequence, Surroundings const& around) const {
    double const scale = rating_kva / around.base_kva();
    Complex const series = 100.0 / Complex{r_percent, x_percent} * scale;
    Complex const half{0, charging_percent / 200 * scale};
    Complex const magnetising{0, -magnetising_percent / 100 * scale};
    double const a = tap_ratio;
    if (sequence == Sequence::negative) {
        Complex const tap = std::polar(a, -phase_shift_deg * std::numbers::pi / 180); // the other way round
        return {(series + half + magnetising) / (a * a), -series / std::conj(tap), -series / tap, series + half};
    }
    bool const from_earthed = from_winding == Winding::wye_grounded, to_earthed = to_winding == Winding::wye_grounded;
    bool const through = from_earthed && to_earthed;
    Admittances y;
    if (from_earthed) {
        y.ff = (half + magnetising) / (a * a);
        y.ff += through || to_winding == Winding::delta ? series / (a * a) : Complex{};
    }
    if (to_earthed) {
        y.tt = half + (through || from_winding == Winding::delta ? series : Complex{});
    }
    if (through) {
        y.ft = y.tf = -series / a;
    }
    return y;
}

EarthPaths Transformer::earth_paths(Surroundings const&, Ends closed) const {
    bool const from_star = from_winding == Winding::wye_grounded, to_star = to_winding == Winding::wye_grounded;
    bool const charged = charging_percent != 0;
    bool const from_earth = from_star && (to_winding == Winding::delta || magnetising_percent > 0);
    bool const to_earth = to_star && from_winding == Winding::delta;
    return {from_star && to_star && closed.from && closed.to, (charged || from_earth) && closed.from,
            (charged || to_earth) && closed.to};
}

} // namespace gridspace::sim
