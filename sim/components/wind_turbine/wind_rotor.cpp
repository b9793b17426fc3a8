// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/wind_turbine/wind_rotor.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace gridspace::sim::wind {
namespace {

constexpr double kFeatherDeg = 90; ///< blades out of the wind
constexpr double kBrakePu = 0.1;   ///< torque of the brake of one that is stopped
constexpr double kSlowest = 0.02;  ///< below this speed torques are computed at it

/// The bound between which `f` changes its sign, from above 0 at `low` to below at `high`.
template <class F>
double bisect(F const& f, double low, double high) {
    for (int i = 0; i < 100; ++i) {
        double const middle = (low + high) / 2;
        (f(middle) > 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

/// The power order leaves the cube for a straight line to nothing within this share above speed_min_pu.
double cube_begins(RotorData const& d) {
    return 1.05 * d.speed_min_pu;
}

double blade_torque(RotorData const& d, double wind, double speed, double pitch) {
    double const turns = std::max(speed, kSlowest);
    return blade_power(d, wind, turns, pitch) / turns;
}

} // namespace

double power_coefficient(RotorData const& d, double ratio, double pitch) {
    double const y = 1 / (ratio + 0.08 * pitch) - 0.035 / (pitch * pitch * pitch + 1);
    auto const& c = d.cp;
    return std::max(0.0, c[0] * (c[1] * y - c[2] * pitch - c[3]) * std::exp(-c[4] * y) + c[5] * ratio);
}

bool RotorData::complete() {
    best_cp = 0;
    for (double ratio = 1; ratio < 20; ratio += 1e-3) {
        if (double const found = power_coefficient(*this, ratio, 0); found > best_cp) {
            best_cp = found;
            best_ratio = ratio;
        }
    }
    return best_cp > 0 && best_ratio < 19.9;
}

double blade_power(RotorData const& d, double wind, double speed, double pitch) {
    if (wind <= 0) {
        return 0;
    }
    double const share = wind / d.rated_wind_m_s;
    return share * share * share * power_coefficient(d, d.best_ratio * speed / share, pitch) / d.best_cp;
}

double power_order(RotorData const& d, double speed, double limit) {
    double const begins = cube_begins(d);
    double const most = std::min(1.0, limit);
    if (speed >= begins) {
        return std::min(speed * speed * speed, most);
    }
    return std::clamp(begins * begins * begins * (speed - d.speed_min_pu) / (begins - d.speed_min_pu), 0.0, most);
}

void derivative(RotorData const& d, Operation const& now, State const& x, State& dx) {
    PitchControl const& p = d.pitch;
    double const driving = blade_torque(d, now.wind_m_s, x[kTurbine], x[kPitch]) -
                           (now.runs ? 0 : kBrakePu * std::clamp(x[kTurbine] / kSlowest, 0.0, 1.0));
    double const braking = now.taken_pu / std::max(x[kMachine], kSlowest);
    if (d.shaft) {
        double const ht = d.inertia_h_s * d.shaft->turbine_share, hg = d.inertia_h_s - ht;
        double const w = 2 * std::numbers::pi * d.shaft->frequency_hz;
        double const between = x[kTurbine] - x[kMachine], damped = x[kTwist] + d.shaft->damping_pu * between;
        dx[kTurbine] = (driving - damped) / (2 * ht);
        dx[kMachine] = (damped - braking) / (2 * hg);
        dx[kTwist] = 2 * ht * hg / d.inertia_h_s * w * w * between;
    } else {
        dx[kTurbine] = dx[kMachine] = (driving - braking) / (2 * d.inertia_h_s);
        dx[kTwist] = 0;
    }
    double const fast = x[kMachine] - 1, asked = p.kp * fast + x[kIntegral];
    double const target = now.runs ? std::clamp(asked, 0.0, p.max_deg) : kFeatherDeg;
    dx[kPitch] = std::clamp((target - x[kPitch]) / p.t_s, -p.rate_deg_s, p.rate_deg_s);
    bool const winds_up = (asked <= 0 && fast < 0) || (asked >= p.max_deg && fast > 0);
    dx[kIntegral] = winds_up || !now.runs ? 0 : p.ki * fast;
    double const order = now.runs ? power_order(d, x[kMachine], now.limit_pu) : 0;
    dx[kPower] = (order - x[kPower]) / d.power_lag_s;
}

std::optional<State> steady_state(RotorData const& d, double wind, bool runs) {
    State x{};
    if (!runs) {
        x[kPitch] = kFeatherDeg;
        return x;
    }
    double const share = wind / d.rated_wind_m_s;
    if (share > 1) {
        auto const beyond = [&](double pitch) { return blade_power(d, wind, 1, pitch) - 1; };
        if (beyond(d.pitch.max_deg) > 0) {
            return {};
        }
        x[kTurbine] = x[kPower] = 1;
        x[kPitch] = x[kIntegral] = bisect(beyond, 0, d.pitch.max_deg);
    } else {
        auto const left = [&](double speed) { return blade_power(d, wind, speed, 0) - power_order(d, speed, 1); };
        x[kTurbine] = share >= cube_begins(d) ? share : bisect(left, kSlowest, cube_begins(d));
        x[kPower] = power_order(d, x[kTurbine], 1);
    }
    x[kMachine] = x[kTurbine];
    x[kTwist] = x[kPower] / x[kMachine];
    return x;
}

void rotor_fields(config::Fields& f, RotorData& out) {
    using namespace elements;
    f.number("rated_wind_m_s", out.rated_wind_m_s, positive("wind at which it reaches its rated power"));
    f.number("cut_out_m_s", out.cut_out_m_s, positive("it stops above this wind"));
    f.number("restart_m_s", out.restart_m_s, positive("and starts again below this one"));
    f.number("speed_min_pu", out.speed_min_pu, at_most_one("speed of the rotor below which it gives no power"));
    f.number("inertia_h_s", out.inertia_h_s, positive("of all that turns, on rated_kw"));
    f.number("power_lag_s", out.power_lag_s, positive("of the power behind its order"));
    f.object("pitch", {.doc = "control of the blades: a PI controller on the speed (WTGPT_A)"}, [&](Fields& g) {
        g.number("kp", out.pitch.kp, not_negative("degrees per p.u. of speed"));
        g.number("ki", out.pitch.ki, not_negative("degrees per p.u. and second"));
        g.number("t_s", out.pitch.t_s, positive("time constant of the servo"));
        g.number("rate_deg_s", out.pitch.rate_deg_s, positive("most speed of the servo"));
        g.number("max_deg", out.pitch.max_deg, positive("largest angle while it runs"));
    });
    f.object("shaft", {.doc = "two masses with an elastic shaft (WTGT_A) instead of one"}, [&](Fields& g) {
        Shaft& shaft = out.shaft.emplace();
        NumberSpec share = positive("inertia of the blades as a share of inertia_h_s");
        share.max = 0.99;
        g.number("turbine_share", shaft.turbine_share, share);
        g.number("frequency_hz", shaft.frequency_hz, positive("at which it rings when both ends are free"));
        g.number("damping_pu", shaft.damping_pu, not_negative("torque per difference of speeds"));
    });
    std::vector<double> cp;
    f.numbers("cp", cp, {.doc = "c1 to c6 of the power coefficient"});
    if (!cp.empty() && cp.size() != out.cp.size()) {
        f.error("cp", fmt::format("{} numbers", cp.size()), "give six: c1 to c6 of Heier's formula");
    } else if (!cp.empty()) {
        std::copy(cp.begin(), cp.end(), out.cp.begin());
    }
    if (!out.complete()) {
        f.error("cp", "the power coefficient has no maximum above 0 between tip speed ratios of 1 and 20",
                "look at the order of c1 to c6");
    }
    if (out.restart_m_s > out.cut_out_m_s) {
        f.error("restart_m_s", fmt::format("{} m/s is above cut_out_m_s", out.restart_m_s), "it must be below");
    }
    if (out.cut_out_m_s <= out.rated_wind_m_s) {
        f.error("cut_out_m_s", fmt::format("{} m/s is not above rated_wind_m_s", out.cut_out_m_s));
    }
}

} // namespace gridspace::sim::wind
