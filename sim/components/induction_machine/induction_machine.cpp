// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/induction_machine/induction_machine.hpp"

#include "sim/components/induction_machine/induction_equations.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

namespace {

void read_constants(Fields& c, InductionMachine::Constants& pu) {
    c.number("rs", pu.rs, not_negative("resistance of the stator", true));
    c.number("xs", pu.xs, positive("leakage reactance of the stator", true));
    c.number("xm", pu.xm, positive("magnetising reactance", true));
    c.number("rr", pu.cage.r, positive("resistance of the cage", true));
    c.number("xr", pu.cage.x, positive("leakage reactance of the cage", true));
    RotorCage second;
    c.number("rr2", second.r, positive("resistance of a second cage"));
    c.number("xr2", second.x, positive("leakage reactance of a second cage"));
    if (second.r > 0 && second.x > 0) {
        pu.second_cage = second;
    } else if (second.r > 0 || second.x > 0) {
        c.error(second.r > 0 ? "rr2" : "xr2", "a second cage has both `rr2` and `xr2`", "give both, or neither");
    }
}

} // namespace

void InductionMachine::fields(Fields& f) {
    f.number("rating_kva", rating_kva, positive("rated apparent power", true));
    f.number("load_kw", load_kw, any("mechanical power of its load at nominal speed; negative: it is driven", true));
    NumberSpec exponent = not_negative("of the speed in the torque of the load: 0 a conveyor, 2 a fan");
    exponent.max = 5;
    f.number("load_exponent", load_exponent, exponent);
    f.number("inertia_h_s", inertia_h_s, positive("inertia constant of machine and load", true));
    f.object("constants_pu", {.doc = "of its equivalent circuit, on its rating", .required = true},
             [&](Fields& c) { read_constants(c, pu); });
    f.choice<bool>("state", running, {{"running", true}, {"stopped", false}},
                   {.doc = "carries its load at the start, or stands still behind an open contactor"});
    bool const complete = rating_kva > 0 && pu.xs > 0 && pu.xm > 0 && pu.cage.r > 0 && pu.cage.x > 0;
    if (complete && running) {
        induction::Machine const machine{*this};
        if (induction::Operation const at = machine.operation(1); !at.carries) {
            f.error("load_kw",
                    fmt::format(
                        "'{}' cannot carry {:.4g} kW at its nominal voltage: its breakdown torque is that of {:.4g} kW",
                        name.name, load_kw, machine.torque(at.slip, 1) * rating_kva),
                    "a smaller load, a larger rating_kva, or other constants_pu");
        }
    }
}

bool InductionMachine::set(std::string_view /*quantity*/, double value) {
    load_kw = value;
    return true;
}

VoltagePower InductionMachine::factor(double v, double /*floor_pu*/) const {
    induction::Machine const machine{*this};
    auto const power = [&](double at) { return at * at / std::conj(machine.impedance(machine.operation(at).slip)); };
    double const step = 1e-5 * (v > 0 ? v : 1);
    Complex const s = power(v), slope = (power(v + step) - power(v - step)) / (2 * step);
    return {s.real(), s.imag(), slope.real(), slope.imag()};
}

Complex InductionMachine::sequence_pu(Sequence sequence, Surroundings const& around) const {
    constexpr double kAgainst = 2; // slip of a rotor near its speed against a voltage that turns the other way
    return sequence == Sequence::zero ? Complex{}
                                      : rating_kva / around.base_kva() / induction::Machine{*this}.impedance(kAgainst);
}

} // namespace gridspace::sim
