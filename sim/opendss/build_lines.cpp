// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// Lines and their codes.
namespace gridspace::opendss {
namespace {

/// Impedances per unit of length: symmetrical components, or matrices.
struct LineImpedance {
    int phases{3};
    bool by_sequence{true}, capacitance_given{false};
    double r1{0.058}, x1{0.1206}, r0{0.1784}, x0{0.4047}; ///< ohm per 1000 ft: OpenDSS's defaults
    double c1_nf{3.4}, c0_nf{1.6};
    Eigen::MatrixXd r, x, c_nf;
    double base_hz{60};
    double unit_m{0}; ///< of the length; 0: none

    void order(int n) {
        if (n != phases) {
            phases = n;
            by_sequence = true; // matrices of another order say nothing
        }
    }
    /// Matrices where only some were given: of the others, what the components say.
    void to_matrices() {
        if (!by_sequence) {
            return;
        }
        r = series().real();
        x = series().imag();
        c_nf = capacitance();
        by_sequence = false; // the last, for until then it is what they are made of
    }
    [[nodiscard]] Eigen::MatrixXcd series() const {
        if (!by_sequence) {
            return r.cast<Complex>() + Complex{0, 1} * x.cast<Complex>();
        }
        Complex const one{r1, x1};
        return from_sequences(phases, one, phases == 1 ? one : Complex{r0, x0});
    }
    [[nodiscard]] Eigen::MatrixXd capacitance() const {
        return by_sequence ? from_sequences(phases, {c1_nf, 0}, {phases == 1 ? c1_nf : c0_nf, 0}).real() : c_nf;
    }
};

/// The properties of impedance that lines and codes share. `changed` is called when one of them is given.
Meaning impedance_meaning(LineImpedance& z, std::function<void(bool by_sequence)> changed) {
    auto const component = [&z, changed](double LineImpedance::* member, bool capacitance) {
        return [&z, changed, member, capacitance](Value const& v) {
            z.*member = v.number();
            z.by_sequence = true;
            z.capacitance_given = z.capacitance_given || capacitance;
            changed(true);
        };
    };
    auto const susceptance = [&z, changed](double LineImpedance::* member) { // microsiemens
        return [&z, changed, member](Value const& v) {
            z.*member = v.number() * 1e3 / (2 * std::numbers::pi * z.base_hz);
            z.by_sequence = z.capacitance_given = true;
            changed(true);
        };
    };
    auto const matrix = [&z, changed](Eigen::MatrixXd LineImpedance::* member, bool capacitance) {
        return [&z, changed, member, capacitance](Value const& v) {
            z.to_matrices();
            z.*member = v.matrix(z.phases);
            z.capacitance_given = z.capacitance_given || capacitance;
            changed(false);
        };
    };
    return {{"r1", component(&LineImpedance::r1, false)},
            {"x1", component(&LineImpedance::x1, false)},
            {"r0", component(&LineImpedance::r0, false)},
            {"x0", component(&LineImpedance::x0, false)},
            {"c1", component(&LineImpedance::c1_nf, true)},
            {"c0", component(&LineImpedance::c0_nf, true)},
            {"b1", susceptance(&LineImpedance::c1_nf)},
            {"b0", susceptance(&LineImpedance::c0_nf)},
            {"rmatrix", matrix(&LineImpedance::r, false)},
            {"xmatrix", matrix(&LineImpedance::x, false)},
            {"cmatrix", matrix(&LineImpedance::c_nf, true)},
            {"basefreq", [&z](Value const& v) { z.base_hz = v.positive(); }}};
}

LineImpedance read_code(Object const& code, double base_hz, config::Diagnostics& diagnostics) {
    LineImpedance z;
    z.base_hz = base_hz;
    Meaning meaning = impedance_meaning(z, [](bool) {});
    meaning["nphases"] = [&](Value const& v) { z.order(v.integer(1, kMaxPhases)); };
    meaning["units"] = [&](Value const& v) { z.unit_m = metres(v); };
    meaning["kron"] = [](Value const& v) {
        if (v.yes()) {
            v.wrong("asks for a Kron reduction", "give the reduced matrices");
        }
    };
    replay(code, meaning, diagnostics);
    return z;
}

/// A line as its properties say, one after the other. The length is `units` units of that in which the impedance is
/// given; of a code or of conductors the unit is theirs, and of matrices and components that of the line.
struct LineData {
    LineImpedance z;
    double length{1}, unit_m{0}, scale{1}, code_unit_m{0};
    bool of_code{false};

    [[nodiscard]] double units() const { return length / scale; }
    /// Impedances of its own take the place of those of a code.
    void is_own() {
        of_code = false;
        scale = 1;
        unit_m = 0;
    }
    void take_code(LineImpedance code) {
        z = std::move(code);
        of_code = true;
        code_unit_m = z.unit_m;
        scale = converted(code_unit_m, unit_m);
    }
    /// Constants of conductors are per metre, and hold from where they are named.
    void take(std::optional<LineConstants> const& constants, double frequency_hz) {
        if (!constants) {
            return;
        }
        z.order(static_cast<int>(constants->z_ohm_per_m.rows()));
        z.by_sequence = false;
        z.capacitance_given = of_code = true;
        z.base_hz = frequency_hz;
        z.r = constants->z_ohm_per_m.real();
        z.x = constants->z_ohm_per_m.imag();
        z.c_nf = constants->c_f_per_m * 1e9;
        code_unit_m = 1;
        scale = converted(code_unit_m, unit_m);
    }
    void take_unit(double given) {
        scale = of_code ? converted(code_unit_m, given) : scale * converted(unit_m, given);
        unit_m = given;
    }
    void become_switch() {
        z.by_sequence = z.capacitance_given = true;
        z.r1 = z.x1 = z.r0 = z.x0 = 1;
        z.c1_nf = 1.1;
        z.c0_nf = 1;
        length = 0.001;
        is_own();
    }
    /// Nobody has said its capacitance: the default is per 1000 ft.
    void complete() {
        if (z.by_sequence && !z.capacitance_given && unit_m > 0 && !of_code) {
            z.c1_nf *= unit_m / 304.8;
            z.c0_nf *= unit_m / 304.8;
        }
    }

  private:
    static double converted(double from, double to) { return from == 0 || to == 0 ? 1 : from / to; }
};

/// The properties of a line beside those of its impedance, its code and its conductors.
void line_meaning(LineData& d, Meaning& meaning) {
    meaning["length"] = [&d](Value const& v) { d.length = v.positive(); };
    meaning["units"] = [&d](Value const& v) { d.take_unit(metres(v)); };
    meaning["phases"] = [&d](Value const& v) {
        int const phases = v.integer(1, kMaxPhases);
        if (phases != d.z.phases && !d.z.by_sequence) {
            v.wrong(fmt::format("is {}, and its matrices are of order {}", phases, d.z.phases),
                    "expected the phases before the matrices, and those of the linecode");
            return;
        }
        d.z.order(phases);
    };
    meaning["switch"] = [&d](Value const& v) {
        if (v.yes()) {
            d.become_switch();
        }
    };
    for (char const* cable : {"cncables", "tscables"}) {
        meaning[cable] = [](Value const& v) {
            v.wrong("are given: constants of cables are not computed", "give a linecode, or the line's matrices");
        };
    }
}

} // namespace

void Builder::line(Object const& object) {
    LineData d;
    d.z.base_hz = circuit_.frequency_hz;
    Terminals at{object.where};
    Meaning meaning = impedance_meaning(d.z, [&](bool) { d.is_own(); });
    at.add_to(meaning);
    line_meaning(d, meaning);
    meaning["linecode"] = [&](Value const& v) {
        Object const* code = script_.find("linecode", lower(v.text()));
        if (code == nullptr) {
            v.wrong(fmt::format("'{}' does not exist", v.text()), "expected the name of a linecode");
            return;
        }
        d.take_code(read_code(*code, circuit_.frequency_hz, diagnostics_));
    };
    Earth const earth = earth_below(object);
    std::optional<Word> spacing;
    meaning["geometry"] = [&](Value const& v) { d.take(geometry(v, earth), circuit_.frequency_hz); };
    meaning["spacing"] = [&](Value const& v) { spacing = v.word(); };
    meaning["wires"] = [&](Value const& v) {
        if (!spacing) {
            v.wrong("come before the spacing", "expected spacing=… wires=[…]");
            return;
        }
        d.take(spaced_wires(Value{*spacing, object, "spacing", diagnostics_}, v, earth), circuit_.frequency_hz);
    };
    replay(object, meaning, diagnostics_);
    d.complete();
    if (at.bus1.empty() || at.bus2.empty()) {
        error(object.where, fmt::format("line.{} has no bus{}", object.name, at.bus1.empty() ? 1 : 2));
        return;
    }
    Eigen::MatrixXcd series = d.z.series() * d.units();
    series.imag() *= circuit_.frequency_hz / d.z.base_hz;
    Eigen::FullPivLU<Eigen::MatrixXcd> const lu{series};
    if (!lu.isInvertible()) {
        error(object.where, fmt::format("line.{} has an impedance without an inverse", object.name),
              "expected an impedance other than 0");
        return;
    }
    add_between(object, at, lu.inverse(),
                d.z.capacitance().cast<Complex>() * Complex{0, omega_ * 1e-9 * d.units() / 2});
}

} // namespace gridspace::opendss
