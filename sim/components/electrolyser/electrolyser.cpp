// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/electrolyser/electrolyser.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

/// An electrolyser in the network file and in the power flow.
namespace gridspace::sim {

using namespace elements;

namespace {

/// Above this voltage a cell makes more heat than hydrogen: twice the thermoneutral voltage at 25 degrees C.
constexpr double kWastefulCellV = 2 * 1.481;

void describe_curve(Fields& f, CellCurve& c) {
    f.number("r1", c.r1, any("ohm m2: resistance of the cell"));
    f.number("r2", c.r2, any("ohm m2 per degree C"));
    f.number("s", c.s, not_negative("V: of the overvoltage at the electrodes"));
    f.number("t1", c.t1, any("m2 / A"));
    f.number("t2", c.t2, any("m2 degree C / A"));
    f.number("t3", c.t3, any("m2 degree C2 / A"));
    f.number("f1", c.f1, not_negative("mA2 / cm4: of the current efficiency"));
    f.number("f2", c.f2, at_most_one("current efficiency at large currents"));
}

} // namespace

void Electrolyser::fields(Fields& f) {
    f.number("rated_kw", rated_kw, positive("most power that it draws", true));
    f.number("p_kw", p_kw, not_negative("power that it is asked to draw"));
    f.number("efficiency", efficiency, at_most_one("of the rectifier"));
    f.number("power_factor", power_factor, at_most_one("of the rectifier, lagging"));
    f.number("min_load_percent", min_load_percent, percent("of rated_kw; asked for less it stands by"));
    f.number("standby_kw", standby_kw, not_negative("drawn while it stands by"));
    f.number("ramp_up_s", ramp_up_s, positive("from nothing to rated_kw"));
    f.number("ramp_down_s", ramp_down_s, positive("from rated_kw to nothing"));
    NumberSpec in_series = positive("in series");
    in_series.max = 1e6;
    f.integer("cells", cells, in_series);
    f.number("cell_area_m2", stack.area_m2, positive("of the electrodes"));
    f.number("temperature_c", stack.temperature_c, positive("of the cells, degrees C"));
    f.object("cell", {.doc = "polarisation curve and current efficiency [Ulleberg 2003]"},
             [&](Fields& c) { describe_curve(c, stack.curve); });
    f.reference("scale", scale, {.doc = "profile that multiplies p_kw"});
    stack.cells = static_cast<double>(cells);
    if (rated_kw > 0 && p_kw > rated_kw * (1 + 1e-9)) {
        f.error("p_kw", fmt::format("'{}' is asked for {:.4g} kW, more than its rated_kw of {:.4g}", name.name, p_kw,
                                    rated_kw));
    }
    if (standby_kw > rated_kw && rated_kw > 0) {
        f.error("standby_kw", fmt::format("'{}' draws {:.4g} kW while it stands by, more than its rated_kw of {:.4g}",
                                          name.name, standby_kw, rated_kw));
    }
    double const resistance = stack.resistance_ohm_m2(), activation = stack.activation_m2_per_a();
    if (resistance < 0 || activation < 0) {
        f.error("temperature_c",
                fmt::format("the voltage of a cell of '{}' does not rise with its current at {:.4g} degrees C: {} is "
                            "{:.4g}",
                            name.name, stack.temperature_c, resistance < 0 ? "r1 + r2 T" : "t1 + t2 / T + t3 / T^2",
                            resistance < 0 ? resistance : activation),
                "stay within the temperatures for which its `cell` holds; the default one does to 107 degrees C");
    } else if (double const v = stack.cell_v(current_a(1)); rated_kw > 0 && cells > 0 && v > kWastefulCellV) {
        f.error("rated_kw",
                fmt::format("the cells of '{}' would have {:.3g} V each at {:.4g} kW, more heat than hydrogen",
                            name.name, v, rated_kw),
                "give it more cells, or a larger cell_area_m2");
    }
}

double Electrolyser::target(double times) const {
    double const share = std::clamp(p_kw * times / rated_kw, 0.0, 1.0);
    return share < min_load_percent / 100 * (1 - 1e-12) ? 0 : share;
}

Complex Electrolyser::drawn_kva(double share, bool stands_by) const {
    double const p = share * rated_kw + (stands_by ? standby_kw : 0);
    return {p, p * std::sqrt(1 - power_factor * power_factor) / power_factor};
}

double Electrolyser::let_through(Complex wanted_kva, double v) const {
    double const wanted = std::abs(wanted_kva);
    return wanted > 0 ? std::abs(within_rating(wanted_kva, v, rating_kva())) / wanted : 1;
}

std::vector<SignalDef> Electrolyser::signals() {
    return {{"hydrogen_kg", "kg"}, {"current_a", "A"}, {"cell_v", "V"}, {"specific_kwh_per_kg", "kWh/kg"}};
}

double Electrolyser::signal(std::size_t index, double share, double hydrogen_g) const {
    if (index == 0) {
        return hydrogen_g / 1e3;
    }
    double const i = current_a(share);
    if (index == 1) {
        return i;
    }
    if (index == 2) {
        return stack.cell_v(i);
    }
    double const kg_per_h = 3.6 * stack.hydrogen_g_per_s(i);
    return kg_per_h > 0 ? share * rated_kw / kg_per_h : 0;
}

void Electrolyser::power_flow(PowerFlowFace& face) const {
    double const share = target(face.scale(scale));
    face.inject(bus, -drawn_kva(share, share == 0));
}

} // namespace gridspace::sim
