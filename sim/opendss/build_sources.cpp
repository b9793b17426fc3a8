// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// Voltage sources, capacitors and reactors.
namespace gridspace::opendss {
namespace {

/// The bus of the other end of what is connected to earth there: "671.1.2.3" gives "671.0.0.0".
std::string earthed(std::string const& bus, int conductors) {
    std::string out = bus.substr(0, bus.find('.'));
    for (int i = 0; i < conductors; ++i) {
        out += ".0";
    }
    return out;
}

/// A ring of equal branches over the conductors; one or two phases are an open ring over one conductor more.
Eigen::MatrixXcd ring(int phases, Complex y) {
    int const conductors = phases < 3 ? phases + 1 : phases;
    Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(conductors, conductors);
    for (int k = 0; k < phases; ++k) {
        int const next = (k + 1) % conductors;
        out(k, k) += y;
        out(next, next) += y;
        out(k, next) -= y;
        out(next, k) -= y;
    }
    return out;
}

struct SourceData {
    enum class Given { power, current, impedance };
    double kv{115}, pu{1}, angle_deg{0};
    int phases{3};
    double mva3{2000}, mva1{2100}, a3{10000}, a1{10540}, x1r1{4}, x0r0{3}, base_mva{100};
    Complex z1{1.65, 6.6}, z2, z0{1.9, 5.7};
    bool z2_given{false}, z0_given{false};
    Given given{Given::power};

    /// Positive and zero sequence impedance from short-circuit powers or currents.
    bool from_short_circuit() {
        double const factor = phases == 1 ? 1 : kSqrt3;
        double const power3 = given == Given::power ? mva3 : kSqrt3 * kv * a3 / 1e3;
        double const current1 = given == Given::power ? mva1 * 1e3 / (factor * kv) : a1;
        double const x1 = kv * kv / power3 / std::sqrt(1 + 1 / (x1r1 * x1r1)), r1 = x1 / x1r1;
        z1 = {r1, x1};
        // |2 z1 + z0| = 3 V / I1 with z0 = r0 (1 + j x0r0)
        double const a = 1 + x0r0 * x0r0, b = 4 * (r1 + x1 * x0r0),
                     c = 4 * std::norm(z1) - std::pow(3e3 * kv / factor / current1, 2), root = b * b - 4 * a * c;
        double const r0 = (-b + std::sqrt(std::max(root, 0.0))) / (2 * a);
        z0 = {r0, r0 * x0r0};
        return root >= 0;
    }
};

} // namespace

void Builder::source(Object const& object) {
    SourceData s;
    std::string bus, other;
    config::SourceMark where = object.where, other_where = object.where;
    auto const scalar = [&s](double SourceData::* member, SourceData::Given given) {
        return [&s, member, given](Value const& v) {
            s.*member = v.positive();
            s.given = given;
        };
    };
    auto const part = [&s](Complex SourceData::* member, bool imaginary) {
        return [&s, member, imaginary](Value const& v) {
            Complex& z = s.*member;
            z = imaginary ? Complex{z.real(), v.number()} : Complex{v.number(), z.imag()};
            s.given = SourceData::Given::impedance;
            s.z0_given = s.z0_given || member == &SourceData::z0;
        };
    };
    auto const impedance = [&s](Complex SourceData::* member, bool pu) {
        return [&s, member, pu](Value const& v) {
            s.*member = v.complex() * (pu ? s.kv * s.kv / s.base_mva : 1.0);
            s.given = SourceData::Given::impedance;
            s.z2_given = s.z2_given || member == &SourceData::z2;
            s.z0_given = s.z0_given || member == &SourceData::z0;
            if (member == &SourceData::z1 && !s.z0_given) {
                s.z0 = s.z1;
            }
        };
    };
    using Given = SourceData::Given;
    replay(object,
           {{"bus1", [&](Value const& v) { bus = v.text(), where = v.where(); }},
            {"bus2", [&](Value const& v) { other = v.text(), other_where = v.where(); }},
            {"basekv", [&](Value const& v) { s.kv = v.positive(); }},
            {"pu", [&](Value const& v) { s.pu = v.positive(); }},
            {"angle", [&](Value const& v) { s.angle_deg = v.number(); }},
            {"phases", [&](Value const& v) { s.phases = v.integer(1, kMaxPhases); }},
            {"frequency",
             [&](Value const& v) {
                 if (v.positive() != circuit_.frequency_hz) {
                     v.wrong(fmt::format("is not the circuit's {} Hz", circuit_.frequency_hz),
                             "one frequency at a time");
                 }
             }},
            {"mvasc3", scalar(&SourceData::mva3, Given::power)},
            {"mvasc1", scalar(&SourceData::mva1, Given::power)},
            {"isc3", scalar(&SourceData::a3, Given::current)},
            {"isc1", scalar(&SourceData::a1, Given::current)},
            {"x1r1", [&](Value const& v) { s.x1r1 = v.positive(); }},
            {"x0r0", [&](Value const& v) { s.x0r0 = v.positive(); }},
            {"r1", part(&SourceData::z1, false)},
            {"x1", part(&SourceData::z1, true)},
            {"r0", part(&SourceData::z0, false)},
            {"x0", part(&SourceData::z0, true)},
            {"basemva", [&](Value const& v) { s.base_mva = v.positive(); }},
            {"z1", impedance(&SourceData::z1, false)},
            {"z2", impedance(&SourceData::z2, false)},
            {"z0", impedance(&SourceData::z0, false)},
            {"puz1", impedance(&SourceData::z1, true)},
            {"puz2", impedance(&SourceData::z2, true)},
            {"puz0", impedance(&SourceData::z0, true)}},
           diagnostics_);
    bus = bus.empty() ? "sourcebus" : bus;
    if (s.given != Given::impedance && !s.from_short_circuit()) {
        error(object.where,
              fmt::format("vsource.{}: no zero sequence impedance gives its single-phase short circuit", object.name),
              "expected MVAsc1 below three times MVAsc3");
        return;
    }
    Complex const z0 = s.phases == 1 ? s.z1 : s.z0, z2 = s.z2_given && s.phases == 3 ? s.z2 : s.z1;
    Eigen::MatrixXcd z = from_sequences(s.phases, s.z1, z0);
    Complex const turn = std::polar(1.0, -2 * std::numbers::pi / s.phases);
    if (z2 != s.z1) {
        Complex const a = std::conj(turn);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                Complex const shift = std::pow(a, static_cast<double>(j - i));
                z(i, j) = (z0 + shift * s.z1 + std::conj(shift) * z2) / 3.0;
            }
        }
    }
    Eigen::FullPivLU<Eigen::MatrixXcd> const lu{z};
    if (!lu.isInvertible()) {
        error(object.where, fmt::format("vsource.{} has an impedance without an inverse", object.name),
              "expected an impedance other than 0, such as x1=0.0001");
        return;
    }
    double const v = s.kv * 1e3 * s.pu * (s.phases == 1 ? 1 : 1 / (2 * std::sin(std::numbers::pi / s.phases)));
    Eigen::VectorXcd emf = Eigen::VectorXcd::Zero(2 * s.phases);
    for (int i = 0; i < s.phases; ++i) {
        emf[i] = std::polar(v, s.angle_deg * std::numbers::pi / 180) * std::pow(turn, static_cast<double>(i));
    }
    std::vector<int> nodes = connect(bus, where, s.phases, s.phases);
    std::vector<int> const back =
        connect(other.empty() ? earthed(bus, s.phases) : other, other_where, s.phases, s.phases);
    nodes.insert(nodes.end(), back.begin(), back.end());
    Eigen::MatrixXcd y = two_terminals(lu.inverse(), Eigen::MatrixXcd::Zero(s.phases, s.phases));
    Eigen::VectorXcd injected = y * emf;
    add(object, std::move(nodes), s.phases, std::move(y), std::move(injected));
}

void Builder::capacitor(Object const& object) {
    int phases = 3;
    double kv = 12.47, farads = 0;
    bool delta = false, by_farads = false;
    std::vector<double> kvar{1200}, r, xl, states, micro;
    Eigen::MatrixXd matrix_uf;
    std::string bus, other;
    config::SourceMark where = object.where, other_where = object.where;
    replay(object,
           {{"bus1", [&](Value const& v) { bus = v.text(), where = v.where(); }},
            {"bus2", [&](Value const& v) { other = v.text(), other_where = v.where(); }},
            {"phases", [&](Value const& v) { phases = v.integer(1, kMaxPhases); }},
            {"kvar", [&](Value const& v) { kvar = v.list(), by_farads = false, matrix_uf = {}; }},
            {"kv", [&](Value const& v) { kv = v.positive(); }},
            {"conn", [&](Value const& v) { delta = v.delta(); }},
            {"cuf", [&](Value const& v) { micro = v.list(), by_farads = true, matrix_uf = {}; }},
            {"cmatrix", [&](Value const& v) { matrix_uf = v.matrix(phases); }},
            {"r", [&](Value const& v) { r = v.list(); }},
            {"xl", [&](Value const& v) { xl = v.list(); }},
            {"numsteps",
             [&](Value const& v) { // the same in each step
                 auto const n = static_cast<std::size_t>(v.integer(1, 100));
                 if (kvar.size() == 1) {
                     kvar.assign(n, kvar.front() / static_cast<double>(n));
                 }
             }},
            {"states", [&](Value const& v) { states = v.list(); }}},
           diagnostics_);
    if (bus.empty()) {
        error(object.where, fmt::format("capacitor.{} has no bus1", object.name));
        return;
    }
    double const phase_kv = !delta && (phases == 2 || phases == 3) ? kv / kSqrt3 : kv;
    Complex y_phase{};
    std::vector<double> const& steps = by_farads ? micro : kvar;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (i < states.size() && states[i] == 0) {
            continue;
        }
        farads = by_farads ? steps[i] * 1e-6 : steps[i] * 1e3 / phases / (omega_ * phase_kv * phase_kv * 1e6);
        Complex const y{0, omega_ * farads}, z{i < r.size() ? r[i] : 0, i < xl.size() ? xl[i] : 0};
        y_phase += z == Complex{} || y == Complex{} ? y : 1.0 / (1.0 / y + z);
    }
    bool const in_service = states.empty() || y_phase != Complex{};
    if (delta) {
        Eigen::MatrixXcd y = ring(phases, y_phase);
        auto const conductors = static_cast<int>(y.rows());
        add(object, connect(bus, where, phases, conductors), conductors, std::move(y));
    } else {
        Eigen::MatrixXcd const series = matrix_uf.size() > 0
                                            ? Eigen::MatrixXcd{matrix_uf.cast<Complex>() * Complex{0, omega_ * 1e-6}}
                                            : star(phases, y_phase);
        std::vector<int> nodes = connect(bus, where, phases, phases);
        std::vector<int> const back =
            connect(other.empty() ? earthed(bus, phases) : other, other_where, phases, phases);
        nodes.insert(nodes.end(), back.begin(), back.end());
        add(object, std::move(nodes), phases, two_terminals(series, Eigen::MatrixXcd::Zero(phases, phases)));
    }
    if (!circuit_.elements.empty()) {
        circuit_.elements.back().in_service = in_service;
    }
}

void Builder::reactor(Object const& object) {
    int phases = 3;
    double kv = 12.47, kvar = 1200, r = 0, x = 0, rp = 0;
    bool delta = false, parallel = false;
    enum class Given { power, impedance, matrices, sequences } given = Given::power;
    Complex z1, z0, z2;
    bool z0_given = false;
    Eigen::MatrixXd rm, xm;
    std::string bus, other;
    config::SourceMark where = object.where, other_where = object.where;
    auto const impedance = [&](double& part) {
        return [&part, &given](Value const& v) {
            part = v.number();
            given = Given::impedance;
        };
    };
    replay(object,
           {{"bus1", [&](Value const& v) { bus = v.text(), where = v.where(); }},
            {"bus2", [&](Value const& v) { other = v.text(), other_where = v.where(); }},
            {"phases", [&](Value const& v) { phases = v.integer(1, kMaxPhases); }},
            {"kvar", [&](Value const& v) { kvar = v.positive(), given = Given::power; }},
            {"kv", [&](Value const& v) { kv = v.positive(); }},
            {"conn", [&](Value const& v) { delta = v.delta(); }},
            {"parallel", [&](Value const& v) { parallel = v.yes(); }},
            {"r", impedance(r)},
            {"x", impedance(x)},
            {"lmh", [&](Value const& v) { x = omega_ * v.number() * 1e-3, given = Given::impedance; }},
            {"z", [&](Value const& v) { r = v.complex().real(), x = v.complex().imag(), given = Given::impedance; }},
            {"rp", [&](Value const& v) { rp = v.number(); }},
            {"rmatrix", [&](Value const& v) { rm = v.matrix(phases), given = Given::matrices; }},
            {"xmatrix", [&](Value const& v) { xm = v.matrix(phases), given = Given::matrices; }},
            {"z1", [&](Value const& v) { z1 = z2 = v.complex(), z0 = z0_given ? z0 : z1, given = Given::sequences; }},
            {"z2", [&](Value const& v) { z2 = v.complex(), given = Given::sequences; }},
            {"z0", [&](Value const& v) { z0 = v.complex(), z0_given = true, given = Given::sequences; }}},
           diagnostics_);
    if (bus.empty()) {
        error(object.where, fmt::format("reactor.{} has no bus1", object.name));
        return;
    }
    if (given == Given::power) {
        double const phase_kv = !delta && (phases == 2 || phases == 3) ? kv / kSqrt3 : kv;
        x = phase_kv * phase_kv * 1e3 / (kvar / phases);
    }
    Eigen::MatrixXcd z;
    if (given == Given::sequences) {
        if (z2 != z1) {
            error(object.where, fmt::format("reactor.{}: Z2 is not Z1", object.name), "expected Z1 and Z0 alone");
        }
        z = from_sequences(phases, z1, z0);
    } else if (given == Given::matrices) {
        Eigen::MatrixXd const none = Eigen::MatrixXd::Zero(phases, phases);
        Complex const j{0, 1};
        z = (rm.size() > 0 ? rm : none).cast<Complex>() + j * (xm.size() > 0 ? xm : none).cast<Complex>();
        if (parallel) {
            error(object.where, fmt::format("reactor.{}: matrices in parallel", object.name),
                  "expected Parallel=No with Rmatrix and Xmatrix");
        }
    }
    Complex y_phase{};
    if (z.size() == 0) {
        y_phase = parallel ? (r == 0 ? Complex{} : Complex{1 / r}) + (x == 0 ? Complex{} : 1.0 / Complex{0, x})
                           : (r == 0 && x == 0 ? Complex{INFINITY} : 1.0 / Complex{r, x});
        y_phase += rp == 0 ? Complex{} : Complex{1 / rp};
    }
    if (delta && z.size() == 0) {
        Eigen::MatrixXcd y = ring(phases, y_phase);
        auto const conductors = static_cast<int>(y.rows());
        add(object, connect(bus, where, phases, conductors), conductors, std::move(y));
        return;
    }
    Eigen::MatrixXcd const series = z.size() == 0 ? star(phases, y_phase) : Eigen::MatrixXcd{z.inverse()};
    std::vector<int> nodes = connect(bus, where, phases, phases);
    std::vector<int> const back = connect(other.empty() ? earthed(bus, phases) : other, other_where, phases, phases);
    nodes.insert(nodes.end(), back.begin(), back.end());
    add(object, std::move(nodes), phases, two_terminals(series, Eigen::MatrixXcd::Zero(phases, phases)));
}

} // namespace gridspace::opendss
