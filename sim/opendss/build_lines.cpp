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

} // namespace

void Builder::line(Object const& object) {
    LineImpedance z;
    z.base_hz = circuit_.frequency_hz;
    double length = 1, unit_m = 0, scale = 1, code_unit_m = 0;
    bool of_code = false;
    std::string bus[2];
    config::SourceMark bus_where[2] = {object.where, object.where};
    auto const converted = [](double from, double to) { return from == 0 || to == 0 ? 1 : from / to; };
    Meaning meaning = impedance_meaning(z, [&](bool) {
        of_code = false;
        scale = 1;
        unit_m = 0;
    });
    for (int i = 0; i < 2; ++i) {
        meaning[i == 0 ? "bus1" : "bus2"] = [&, i](Value const& v) {
            bus[i] = v.text();
            bus_where[i] = v.where();
        };
    }
    meaning["linecode"] = [&](Value const& v) {
        Object const* code = script_.find("linecode", lower(v.text()));
        if (code == nullptr) {
            v.wrong(fmt::format("'{}' does not exist", v.text()), "expected the name of a linecode");
            return;
        }
        z = read_code(*code, circuit_.frequency_hz, diagnostics_);
        of_code = true;
        code_unit_m = z.unit_m;
        scale = converted(code_unit_m, unit_m);
    };
    meaning["length"] = [&](Value const& v) { length = v.positive(); };
    meaning["units"] = [&](Value const& v) {
        double const given = metres(v);
        scale = of_code ? converted(code_unit_m, given) : scale * converted(unit_m, given);
        unit_m = given;
    };
    meaning["phases"] = [&](Value const& v) {
        int const phases = v.integer(1, kMaxPhases);
        if (phases != z.phases && !z.by_sequence) {
            v.wrong(fmt::format("is {}, and its matrices are of order {}", phases, z.phases),
                    "expected the phases before the matrices, and those of the linecode");
            return;
        }
        z.order(phases);
    };
    meaning["switch"] = [&](Value const& v) {
        if (v.yes()) {
            z.by_sequence = z.capacitance_given = true;
            z.r1 = z.x1 = z.r0 = z.x0 = 1;
            z.c1_nf = 1.1;
            z.c0_nf = 1;
            length = 0.001;
            of_code = false;
            scale = 1;
            unit_m = 0;
        }
    };
    // Constants of conductors are per metre, and hold from where they are named.
    std::optional<double> rho;
    std::optional<Word> spacing;
    auto const take = [&](std::optional<LineConstants> const& constants) {
        if (constants) {
            z.order(static_cast<int>(constants->z_ohm_per_m.rows()));
            z.by_sequence = false;
            z.capacitance_given = of_code = true;
            z.base_hz = circuit_.frequency_hz;
            z.r = constants->z_ohm_per_m.real();
            z.x = constants->z_ohm_per_m.imag();
            z.c_nf = constants->c_f_per_m * 1e9;
            code_unit_m = 1;
            scale = converted(code_unit_m, unit_m);
        }
    };
    meaning["rho"] = [&](Value const& v) { rho = v.positive(); };
    meaning["geometry"] = [&](Value const& v) { take(geometry(v, rho)); };
    meaning["spacing"] = [&](Value const& v) { spacing = v.word(); };
    meaning["wires"] = [&](Value const& v) {
        if (!spacing) {
            v.wrong("come before the spacing", "expected spacing=… wires=[…]");
            return;
        }
        take(spaced_wires(Value{*spacing, object, "spacing", diagnostics_}, v, rho));
    };
    for (char const* cable : {"cncables", "tscables"}) {
        meaning[cable] = [](Value const& v) {
            v.wrong("are given: constants of cables are not computed", "give a linecode, or the line's matrices");
        };
    }
    replay(object, meaning, diagnostics_);
    if (z.by_sequence && !z.capacitance_given && unit_m > 0 && !of_code) { // the default is per 1000 ft
        z.c1_nf *= unit_m / 304.8;
        z.c0_nf *= unit_m / 304.8;
    }
    if (bus[0].empty() || bus[1].empty()) {
        error(object.where, fmt::format("line.{} has no bus{}", object.name, bus[0].empty() ? 1 : 2));
        return;
    }
    double const units = length / scale, frequency = circuit_.frequency_hz / z.base_hz;
    Eigen::MatrixXcd series = z.series() * units;
    series.imag() *= frequency;
    Eigen::FullPivLU<Eigen::MatrixXcd> const lu{series};
    if (!lu.isInvertible()) {
        error(object.where, fmt::format("line.{} has an impedance without an inverse", object.name),
              "expected an impedance other than 0");
        return;
    }
    Eigen::MatrixXcd const shunt = z.capacitance().cast<Complex>() * Complex{0, omega_ * 1e-9 * units / 2};
    std::vector<int> nodes = connect(bus[0], bus_where[0], z.phases, z.phases);
    std::vector<int> const to = connect(bus[1], bus_where[1], z.phases, z.phases);
    nodes.insert(nodes.end(), to.begin(), to.end());
    add(object, std::move(nodes), z.phases, two_terminals(lu.inverse(), shunt));
}

} // namespace gridspace::opendss
