// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

/// Capacitors and reactors, between a bus and earth or between two buses.
namespace gridspace::opendss {
namespace {

/// What a reactor says of itself; in OpenDSS's units (kV, kvar, ohm).
struct ReactorData {
    enum class Given { power, impedance, matrices, sequences };
    int phases{3};
    double kv{12.47}, kvar{100}, r{0}, x{0}, rp{0};
    bool delta{false}, parallel{false}, z0_given{false};
    Given given{Given::power};
    Complex z1, z0, z2;
    Eigen::MatrixXd rm, xm;

    [[nodiscard]] bool of_phase() const { return given == Given::power || given == Given::impedance; }
    /// The admittance of a phase.
    [[nodiscard]] Complex branch() const {
        double const phase_kv = !delta && (phases == 2 || phases == 3) ? kv / kSqrt3 : kv;
        double const ohm = given == Given::power ? phase_kv * phase_kv * 1e3 / (kvar / phases) : x;
        Complex const y = parallel
                              ? (r == 0 ? Complex{} : Complex{1 / r}) + (ohm == 0 ? Complex{} : 1.0 / Complex{0, ohm})
                              : (r == 0 && ohm == 0 ? Complex{INFINITY} : 1.0 / Complex{r, ohm});
        return y + (rp == 0 ? Complex{} : Complex{1 / rp});
    }
    [[nodiscard]] Eigen::MatrixXcd impedance() const {
        if (given == Given::sequences) {
            return from_sequences(phases, z1, z0);
        }
        Eigen::MatrixXd const none = Eigen::MatrixXd::Zero(phases, phases);
        return (rm.size() > 0 ? rm : none).cast<Complex>() +
               Complex{0, 1} * (xm.size() > 0 ? xm : none).cast<Complex>();
    }
};

Meaning reactor_meaning(ReactorData& d, double omega) {
    using Given = ReactorData::Given;
    auto const matrix = [&d](Eigen::MatrixXd ReactorData::* part) {
        return [&d, part](Value const& v) { d.*part = v.matrix(d.phases), d.given = Given::matrices; };
    };
    return {
        {"phases", [&d](Value const& v) { d.phases = v.integer(1, kMaxPhases); }},
        {"kvar", [&d](Value const& v) { d.kvar = v.positive(), d.given = Given::power; }},
        {"kv", [&d](Value const& v) { d.kv = v.positive(); }},
        {"conn", [&d](Value const& v) { d.delta = v.delta(); }},
        {"parallel", [&d](Value const& v) { d.parallel = v.yes(); }},
        {"r", [&d](Value const& v) { d.r = v.number(); }}, // beside a reactance of kvar, too
        {"x", [&d](Value const& v) { d.x = v.number(), d.given = Given::impedance; }},
        {"lmh", [&d, omega](Value const& v) { d.x = omega * v.number() * 1e-3, d.given = Given::impedance; }},
        {"z", [&d](Value const& v) { d.r = v.complex().real(), d.x = v.complex().imag(), d.given = Given::impedance; }},
        {"rp", [&d](Value const& v) { d.rp = v.number(); }},
        {"rmatrix", matrix(&ReactorData::rm)},
        {"xmatrix", matrix(&ReactorData::xm)},
        {"z1",
         [&d](Value const& v) {
             d.z1 = d.z2 = v.complex(), d.z0 = d.z0_given ? d.z0 : d.z1, d.given = Given::sequences;
         }},
        {"z2", [&d](Value const& v) { d.z2 = v.complex(), d.given = Given::sequences; }},
        {"z0", [&d](Value const& v) { d.z0 = v.complex(), d.z0_given = true, d.given = Given::sequences; }}};
}

/// Whether a bank's states leave one of its steps closed.
bool any_closed(std::size_t steps, std::vector<double> const& states) {
    return states.size() < steps || std::any_of(
                                        states.begin(), states.begin() + static_cast<std::ptrdiff_t>(steps),
                                        [](double state) { return state != 0; });
}

} // namespace

void Builder::capacitor(Object const& object) {
    int phases = 3;
    double kv = 12.47;
    bool delta = false, by_farads = false;
    std::vector<double> kvar{1200}, r, xl, states, micro;
    Eigen::MatrixXd matrix_uf;
    Terminals at{object.where};
    Meaning meaning{{"phases", [&](Value const& v) { phases = v.integer(1, kMaxPhases); }},
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
                    {"states", [&](Value const& v) { states = v.list(); }}};
    at.add_to(meaning);
    replay(object, meaning, diagnostics_);
    if (at.bus1.empty()) {
        error(object.where, fmt::format("capacitor.{} has no bus1", object.name));
        return;
    }
    double const phase_kv = !delta && (phases == 2 || phases == 3) ? kv / kSqrt3 : kv;
    Complex y_phase{};
    std::vector<double> const& steps = by_farads ? micro : kvar;
    bool const in_service = any_closed(steps.size(), states);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (in_service ? i < states.size() && states[i] == 0 : i > 0) { // of none the first: a control closes it
            continue;
        }
        double const farads =
            by_farads ? steps[i] * 1e-6 : steps[i] * 1e3 / phases / (omega_ * phase_kv * phase_kv * 1e6);
        Complex const y{0, omega_ * farads}, z{i < r.size() ? r[i] : 0, i < xl.size() ? xl[i] : 0};
        y_phase += z == Complex{} || y == Complex{} ? y : 1.0 / (1.0 / y + z);
    }
    if (!delta && matrix_uf.size() > 0) {
        add_between(object, at, matrix_uf.cast<Complex>() * Complex{0, omega_ * 1e-6},
                    Eigen::MatrixXcd::Zero(phases, phases));
    } else {
        add_branches(object, at, phases, delta, y_phase);
    }
    if (!circuit_.elements.empty()) {
        circuit_.elements.back().in_service = in_service;
        double const all = std::accumulate(steps.begin(), steps.end(), 0.0);
        bank_kvar_[circuit_.elements.size() - 1] = by_farads ? all * 1e-3 * phases * omega_ * phase_kv * phase_kv : all;
    }
}

void Builder::reactor(Object const& object) {
    ReactorData d;
    Terminals at{object.where};
    Meaning meaning = reactor_meaning(d, omega_);
    at.add_to(meaning);
    replay(object, meaning, diagnostics_);
    if (at.bus1.empty()) {
        error(object.where, fmt::format("reactor.{} has no bus1", object.name));
        return;
    }
    if (d.given == ReactorData::Given::sequences && d.z2 != d.z1) {
        error(object.where, fmt::format("reactor.{}: Z2 is not Z1", object.name), "expected Z1 and Z0 alone");
    }
    if (d.given == ReactorData::Given::matrices && d.parallel) {
        error(object.where, fmt::format("reactor.{}: matrices in parallel", object.name),
              "expected Parallel=No with Rmatrix and Xmatrix");
    }
    if (d.of_phase()) {
        add_branches(object, at, d.phases, d.delta, d.branch());
    } else {
        add_between(object, at, d.impedance().inverse(), Eigen::MatrixXcd::Zero(d.phases, d.phases));
    }
}

} // namespace gridspace::opendss
