// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/load/load.hpp"

#include <fmt/format.h>

/// The keys of a load, and what goes together.
namespace gridspace::sim {

using namespace elements;

namespace {

void powers_by_phase(Fields& f, Load& l) {
    if (l.phase_p_kw.size() != 3 || l.phase_q_kvar.size() != 3) {
        f.error("", fmt::format("load '{}' needs three phase_p_kw and three phase_q_kvar", l.name.name), "[a, b, c]");
        l.phase_p_kw.clear();
        l.phase_q_kvar.clear();
    } else if (f.has("p_kw") || f.has("q_kvar") || f.has("power_factor")) {
        f.error("phase_p_kw", fmt::format("load '{}' has both powers by phase and of all phases", l.name.name));
    } else {
        l.p_kw = l.phase_p_kw[0] + l.phase_p_kw[1] + l.phase_p_kw[2];
        l.q_kvar = l.phase_q_kvar[0] + l.phase_q_kvar[1] + l.phase_q_kvar[2];
    }
}

} // namespace

void Load::fields(Fields& f) {
    f.numbers("phase_p_kw", phase_p_kw, any("active powers of phases a, b, c at 1 p.u., instead of p_kw"));
    f.numbers("phase_q_kvar", phase_q_kvar, any("reactive powers of phases a, b, c at 1 p.u."));
    bool const by_phase = f.has("phase_p_kw") || f.has("phase_q_kvar");
    f.number("p_kw", p_kw, any("active power at 1 p.u.", !by_phase));
    f.number("power_factor", power_factor, at_most_one("lagging; instead of q_kvar"));
    f.number("q_kvar", q_kvar, any("reactive power at 1 p.u.; instead of a power factor"));
    f.choice<LoadModel>("model", model,
                        {{"constant_power", LoadModel::constant_power},
                         {"constant_current", LoadModel::constant_current},
                         {"constant_impedance", LoadModel::constant_impedance},
                         {"exponential", LoadModel::exponential},
                         {"zip", LoadModel::zip},
                         {"dc_resistive", LoadModel::dc_resistive},
                         {"dc_constant_power", LoadModel::dc_constant_power}},
                        {.doc = "how it depends on voltage"});
    f.number("exponent_p", exponent_p, any("P = p (V/1)^exponent (exponential)"));
    f.number("exponent_q", exponent_q, any("Q = q (V/1)^exponent (exponential)"));
    auto const shares = [&](std::string_view key, std::array<double, 3>& target, std::string_view doc) {
        std::vector<double> given;
        f.numbers(key, given, any(doc));
        if (given.size() == 3) {
            target = {given[0], given[1], given[2]};
            double const sum = given[0] + given[1] + given[2];
            if (sum < 0.999 || sum > 1.001) {
                f.error(key, fmt::format("the shares of '{}' add up to {}, not 1", name.name, sum));
            }
        } else if (f.has(key)) {
            f.error(key, fmt::format("expected three shares, found {}", given.size()),
                    "[constant impedance, constant current, constant power]");
        }
    };
    shares("zip_p", zip_p, "shares of P: constant impedance, current, power (zip)");
    shares("zip_q", zip_q, "shares of Q: constant impedance, current, power (zip)");
    f.number("lag_s", lag_s, not_negative("first-order lag of the power; 0: none"));
    f.reference("scale", scale, {.doc = "profile that multiplies the power"});
    if (by_phase) {
        powers_by_phase(f, *this);
    }
    if (f.has("q_kvar") && f.has("power_factor")) {
        f.error("q_kvar", fmt::format("load '{}' has both q_kvar and power_factor", name.name));
    }
}

/// What the model of a load does not read is a mistake.
void Load::check(ElementCheck& check) const {
    check.profile(scale);
    if (model != LoadModel::exponential && (exponent_p != 0 || exponent_q != 0)) {
        check.wrong("has exponents, but its model is another", "they belong to `model: exponential`");
    }
    std::array<double, 3> const all_power{0, 0, 1};
    if (model != LoadModel::zip && (zip_p != all_power || zip_q != all_power)) {
        check.wrong("has shares zip_p or zip_q, but its model is another", "they belong to `model: zip`");
    }
    if (!is_dc()) {
        return;
    }
    if (!phase_p_kw.empty()) {
        check.wrong("is a DC load: it has no powers by phase", "give p_kw");
    } else if (q_kvar.value_or(0) != 0 || power_factor != 1) {
        check.wrong("is a DC load: its rectifier has unity power factor", "leave out q_kvar and power_factor");
    }
}

} // namespace gridspace::sim
