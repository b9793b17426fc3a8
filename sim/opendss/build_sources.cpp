// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <Eigen/LU>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// Voltage sources.
namespace gridspace::opendss {
namespace {

/// What a source says of itself; in OpenDSS's units (kV, MVA, A, ohm).
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
    /// Of the series branch.
    [[nodiscard]] Eigen::MatrixXcd impedance() const {
        // One phase: of what is given in ohms Z1 alone counts.
        Complex const zero = phases == 1 && given == Given::impedance ? z1 : z0;
        Complex const negative = z2_given && phases == 3 ? z2 : z1;
        Eigen::MatrixXcd z = from_sequences(phases, z1, zero);
        if (negative == z1) {
            return z;
        }
        Complex const a = std::conj(turn());
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                Complex const shift = std::pow(a, static_cast<double>(j - i));
                z(i, j) = (zero + shift * z1 + std::conj(shift) * negative) / 3.0;
            }
        }
        return z;
    }
    /// Of both terminals, V; the second is at rest.
    [[nodiscard]] Eigen::VectorXcd emf() const {
        double const v = kv * 1e3 * pu * (phases == 1 ? 1 : 1 / (2 * std::sin(std::numbers::pi / phases)));
        Eigen::VectorXcd out = Eigen::VectorXcd::Zero(2 * phases);
        for (int i = 0; i < phases; ++i) {
            out[i] = std::polar(v, angle_deg * std::numbers::pi / 180) * std::pow(turn(), static_cast<double>(i));
        }
        return out;
    }
    /// From a phase to the next.
    [[nodiscard]] Complex turn() const { return std::polar(1.0, -2 * std::numbers::pi / phases); }
};

/// The properties that say its impedance, in three ways; the last that is given holds.
void impedance_meaning(SourceData& s, Meaning& meaning) {
    using Given = SourceData::Given;
    auto const scalar = [&s](double SourceData::* member, Given given) {
        return [&s, member, given](Value const& v) {
            s.*member = v.positive();
            s.given = given;
        };
    };
    auto const part = [&s](Complex SourceData::* member, bool imaginary) {
        return [&s, member, imaginary](Value const& v) {
            Complex& z = s.*member;
            z = imaginary ? Complex{z.real(), v.number()} : Complex{v.number(), z.imag()};
            s.given = Given::impedance;
            s.z0_given = s.z0_given || member == &SourceData::z0;
        };
    };
    auto const impedance = [&s](Complex SourceData::* member, bool pu) {
        return [&s, member, pu](Value const& v) {
            s.*member = v.complex() * (pu ? s.kv * s.kv / s.base_mva : 1.0);
            s.given = Given::impedance;
            s.z2_given = s.z2_given || member == &SourceData::z2;
            s.z0_given = s.z0_given || member == &SourceData::z0;
            if (member == &SourceData::z1 && !s.z0_given) {
                s.z0 = s.z1;
            }
        };
    };
    meaning["mvasc3"] = scalar(&SourceData::mva3, Given::power);
    meaning["mvasc1"] = scalar(&SourceData::mva1, Given::power);
    meaning["isc3"] = scalar(&SourceData::a3, Given::current);
    meaning["isc1"] = scalar(&SourceData::a1, Given::current);
    meaning["x1r1"] = [&s](Value const& v) { s.x1r1 = v.positive(); };
    meaning["x0r0"] = [&s](Value const& v) { s.x0r0 = v.positive(); };
    meaning["r1"] = part(&SourceData::z1, false);
    meaning["x1"] = part(&SourceData::z1, true);
    meaning["r0"] = part(&SourceData::z0, false);
    meaning["x0"] = part(&SourceData::z0, true);
    meaning["basemva"] = [&s](Value const& v) { s.base_mva = v.positive(); };
    meaning["z1"] = impedance(&SourceData::z1, false);
    meaning["z2"] = impedance(&SourceData::z2, false);
    meaning["z0"] = impedance(&SourceData::z0, false);
    meaning["puz1"] = impedance(&SourceData::z1, true);
    meaning["puz2"] = impedance(&SourceData::z2, true);
    meaning["puz0"] = impedance(&SourceData::z0, true);
}

} // namespace

void Builder::source(Object const& object) {
    SourceData s;
    Terminals at{object.where};
    Meaning meaning{{"basekv", [&](Value const& v) { s.kv = v.positive(); }},
                    {"pu", [&](Value const& v) { s.pu = v.positive(); }},
                    {"angle", [&](Value const& v) { s.angle_deg = v.number(); }},
                    {"phases", [&](Value const& v) { s.phases = v.integer(1, kMaxPhases); }},
                    {"frequency", [&](Value const& v) {
                         if (v.positive() != circuit_.frequency_hz) {
                             v.wrong(fmt::format("is not the circuit's {} Hz", circuit_.frequency_hz),
                                     "one frequency at a time");
                         }
                     }}};
    at.add_to(meaning);
    impedance_meaning(s, meaning);
    replay(object, meaning, diagnostics_);
    at.bus1 = at.bus1.empty() ? "sourcebus" : at.bus1;
    if (s.given != SourceData::Given::impedance && !s.from_short_circuit()) {
        error(object.where,
              fmt::format("vsource.{}: no zero sequence impedance gives its single-phase short circuit", object.name),
              "expected MVAsc1 below three times MVAsc3");
        return;
    }
    Eigen::FullPivLU<Eigen::MatrixXcd> const lu{s.impedance()};
    if (!lu.isInvertible()) {
        error(object.where, fmt::format("vsource.{} has an impedance without an inverse", object.name),
              "expected an impedance other than 0, such as x1=0.0001");
        return;
    }
    add_between(object, at, lu.inverse(), Eigen::MatrixXcd::Zero(s.phases, s.phases), s.emf());
}

} // namespace gridspace::opendss
