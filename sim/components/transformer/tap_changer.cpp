// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/transformer/tap_changer.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void LineDropCompensation::fields(Fields& f) {
    f.number("r_v", r_v, any("drop by resistance at the rated current of the CT, on a base of `base_v`"));
    f.number("x_v", x_v, any("drop by reactance"));
    f.number("ct_a", ct_a, positive("rated current of the CT, at `to`", true));
    f.number("base_v", base_v, positive("what the voltage transformer gives at the nominal voltage of `to`"));
}

double LineDropCompensation::compensated_pu(double v_pu, std::complex<double> kva, double nominal_v) const {
    if (v_pu <= 0) {
        return 0;
    }
    std::complex<double> const i_a = std::conj(kva) * 1e3 / (std::sqrt(3.0) * v_pu * nominal_v);
    return std::abs(v_pu - std::complex{r_v, x_v} / base_v * i_a / ct_a);
}

void TapChanger::fields(Fields& f) {
    f.reference("bus", bus, {.doc = "whose voltage it holds; without it that of `to`"});
    f.number("voltage_pu", voltage_pu, positive("held voltage"));
    f.number("bandwidth_percent", bandwidth_percent, positive("width of the band around it, of nominal voltage"));
    f.number("delay_s", delay_s, not_negative("before the first step"));
    f.number("next_delay_s", next_delay_s, positive("before each further step of a row"));
    f.number("step_percent", step_percent, positive("of the ratio, each step"));
    constexpr int kMost = 100;
    f.integer("position", position, {.doc = "at the start", .min = -kMost, .max = kMost});
    f.integer("lowest", lowest, {.doc = "position", .min = -kMost, .max = 0});
    f.integer("highest", highest, {.doc = "position", .min = 0, .max = kMost});
    f.number("block_below_pu", block_below_pu, not_negative("it stays where it is below this voltage"));
    f.object("compensation", {.doc = "line drop compensation: it holds the voltage of a load centre down the line"},
             [&](Fields& c) { compensation.emplace().fields(c); });
    if (compensation && !bus.empty()) {
        f.error("compensation", fmt::format("the tap changer holds bus '{}' and compensates from `to`", bus.name),
                "leave out one of `bus` and `compensation`");
    }
    if (position < lowest || position > highest) {
        f.error("position", fmt::format("position {} is not between {} and {}", position, lowest, highest));
    }
    if (static_cast<double>(highest) * step_percent >= 100) {
        f.error("step_percent", fmt::format("at position {} the ratio would be 0 or less", highest),
                "smaller steps, or fewer");
    }
    if (step_percent > bandwidth_percent) {
        f.error("bandwidth_percent",
                fmt::format("a band of {:.3g} % is narrower than a step of {:.3g} %: it would hunt", bandwidth_percent,
                            step_percent),
                "a band of at least a step");
    }
}

bool TapRegulator::step(double v, double h) {
    double const off = v - data_.voltage_pu, half = data_.bandwidth_percent / 200;
    int const wanted = v < data_.block_below_pu || std::abs(off) <= half ? 0 : (off < 0) != reversed_ ? 1 : -1;
    if (wanted == 0 || wanted != direction_) {
        outside_s_ = 0;
        in_a_row_ = false;
    }
    direction_ = wanted;
    if (wanted == 0) {
        return false;
    }
    outside_s_ += h;
    std::int64_t const next = position_ + wanted;
    if (outside_s_ < (in_a_row_ ? data_.next_delay_s : data_.delay_s) || next < data_.lowest || next > data_.highest) {
        return false;
    }
    position_ = next;
    outside_s_ = 0;
    in_a_row_ = true;
    return true;
}

} // namespace gridspace::sim
