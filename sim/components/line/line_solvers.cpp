// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "sim/components/line/line.hpp"
#include "sim/line_constants/mode_fit.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

/// A line in power flow, phasors and waveforms.
namespace gridspace::sim {
namespace {

using Part = emt::CurrentTerm::Kind;
using Section = emt::TwoPortParts::Section;

/// A matrix from its lower triangle aa, ab, bb, ac, bc, cc.
emt::Matrix3 full(std::vector<double> const& lower, double times) {
    constexpr std::size_t kPlace[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
    emt::Matrix3 m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            m[i][j] = lower[kPlace[i][j]] * times;
        }
    }
    return m;
}

PhaseBlock block(Complex one, Complex zero) {
    Complex const mutual = (zero - one) / 3.0;
    PhaseBlock m{};
    for (std::size_t i = 0; i < 3; ++i) {
        m[i].fill(mutual);
        m[i][i] += one;
    }
    return m;
}

LineType const* phase_type(Line const& line, Surroundings const& around) {
    LineType const* type = around.find<LineType>(line.type);
    return type != nullptr && type->by_phase() ? type : nullptr;
}

/// Of a frequency-dependent line; nothing without its data, which was said.
LineType const* type_by_frequency(Line const& line, Surroundings const& around) {
    LineType const* type = around.find<LineType>(line.type);
    return line.model == LineModel::frequency_dependent && type != nullptr && type->by_frequency() ? type : nullptr;
}

/// The modes of a line of this type, which must live as long.
std::pair<ModePerMetre, ModePerMetre> modes_of(LineType const& type) {
    SequencesPerMetre const c = type.per_metre(1);
    return {{[&type](double omega) { return type.per_metre(omega).z1_ohm; }, c.c1_f},
            {[&type](double omega) { return type.per_metre(omega).z0_ohm; }, c.c0_f}};
}

/// The pi that has the same ends at an angular frequency.
PiSection exact_pi(ModePerMetre const& mode, double length_m, double omega) {
    Complex const gamma = mode.per_m(omega) * length_m, surge = mode.surge_ohm(omega);
    return {surge * std::sinh(gamma), std::tanh(gamma / 2.0) / surge};
}

} // namespace

bool Line::unbalanced(Surroundings const& around) const {
    return phase_type(*this, around) != nullptr;
}

std::optional<TwoPort::Pi> Line::pi(Surroundings const& around) const {
    if (LineType const* const own = type_by_frequency(*this, around)) {
        auto const [positive, zero] = modes_of(*own);
        double const length_m = 1e3 * length_km.value_or(0);
        return Pi{exact_pi(positive, length_m, around.omega()), exact_pi(zero, length_m, around.omega())};
    }
    LineTotals const t = totals(around);
    double const omega = around.omega();
    return Pi{{{t.r_ohm, omega * t.l_h}, {0, omega * t.c_f / 2}},
              {{t.r0_ohm, omega * t.l0_h}, {0, omega * t.c0_f / 2}}};
}

/// A line that is open at one end still draws its charging current from the other.
Admittances Line::admittances(Surroundings const& around, Ends closed) const {
    PiSection const section = pi(around)->positive;
    double const z_base = around.base_ohm(from);
    Complex const series = z_base / section.series_ohm;
    Complex const half = section.half_s * z_base;
    Admittances y;
    if (closed.from && closed.to) {
        y.ff = y.tt = series + half;
        y.ft = y.tf = -series;
    } else if (half != Complex{} && closed.from != closed.to) {
        // Seen from the closed end: the near half, and the far half through the line.
        (closed.from ? y.ff : y.tt) = half + series * half / (series + half);
    }
    return y;
}

EarthPaths Line::earth_paths(Surroundings const& around, Ends closed) const {
    LineTotals const t = totals(around);
    bool const charged = t.c_f > 0 || t.c0_f > 0;
    return {closed.from && closed.to, charged && closed.from, charged && closed.to};
}

Result<void> Line::phases(PhaseNetworkFace& face, Surroundings const& around) const {
    LineTotals const t = totals(around);
    double const omega = around.omega();
    PhaseBlock z = block({t.r_ohm, omega * t.l_h}, {t.r0_ohm, omega * t.l0_h});
    if (model == LineModel::frequency_dependent) {
        Pi const exact = *pi(around);
        face.series(block(exact.positive.series_ohm, exact.zero.series_ohm),
                    block(exact.positive.half_s, exact.zero.half_s));
        return {};
    }
    if (LineType const* own = phase_type(*this, around)) {
        double const km = length_km.value_or(0);
        emt::Matrix3 const r = full(own->phase_r_ohm_per_km, 1), x = full(own->phase_x_ohm_per_km, 1);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                z[i][j] = Complex{r[i][j], x[i][j]} * km;
            }
        }
    }
    face.series(z, block({0, omega * t.c_f / 2}, {0, omega * t.c0_f / 2}));
    return {};
}

namespace {

Result<void> wave(emt::Circuit& c, emt::TwoPortParts& parts, Line const& l, LineTotals const& t, bool by_phase) {
    if (by_phase) {
        return fail(ExitCode::usage, fmt::format("line '{}': travelling waves need a transposed line", l.name.name),
                    "use `model: pi`, or give its type r_ohm_per_km, x_ohm_per_km, r0 and x0");
    }
    if (t.l_h <= 0 || t.c_f <= 0 || t.l0_h <= 0 || t.c0_f <= 0) {
        return fail(ExitCode::usage,
                    fmt::format("line '{}': a travelling wave needs inductance and capacitance", l.name.name),
                    "give l_mh and c_nf, or use `model: pi`");
    }
    c.flows(parts.from_switch, Part::bergeron_from, c.bergeron.size(), 1);
    c.flows(parts.to_switch, Part::bergeron_to, c.bergeron.size(), 1);
    parts.sections.push_back({Section::Kind::wave, static_cast<int>(c.bergeron.size()), 0, 1});
    c.bergeron.push_back({parts.from_node, parts.to_node, std::sqrt(t.l_h / t.c_f), std::sqrt(t.l0_h / t.c0_f),
                          std::sqrt(t.l_h * t.c_f), std::sqrt(t.l0_h * t.c0_f), t.r_ohm, t.r0_ohm, l.name.name});
    return {};
}

/// One line in a row for each part between the places where a fault can be.
Result<void> frequency_dependent(emt::Circuit& c, emt::TwoPortParts& parts, Line const& l, LineType const& type,
                                 double omega) {
    auto const [positive, zero] = modes_of(type);
    std::vector<double> places = l.fault_places_percent;
    places.push_back(100);
    double start = 0;
    int from = parts.from_node;
    for (double const percent : places) {
        double const end = percent / 100, length_m = 1e3 * l.length_km.value_or(0) * (end - start);
        auto one = fit_mode(positive, length_m, omega), none = fit_mode(zero, length_m, omega);
        if (!one || !none) {
            Error const& error = one ? none.error() : one.error();
            return fail(error.code, fmt::format("line '{}': {}", l.name.name, error.message), error.remedy);
        }
        bool const last = percent == 100;
        int const to =
            last ? parts.to_node : c.add_triple(fmt::format("line '{}' at {} %", l.name.name, shortest(percent)));
        if (start == 0) {
            c.flows(parts.from_switch, Part::marti_from, c.marti.size(), 1);
        }
        if (last) {
            c.flows(parts.to_switch, Part::marti_to, c.marti.size(), 1);
        }
        parts.sections.push_back({Section::Kind::marti, static_cast<int>(c.marti.size()), start, end});
        c.marti.push_back({from, to, std::move(*one), std::move(*none), l.name.name});
        from = to;
        start = end;
    }
    return {};
}

/// Series impedance: of a transposed line, or with its phases as they are.
void series(emt::Circuit& c, emt::TwoPortParts& parts, Line const& l, LineTotals const& t, LineType const* by_phase,
            double omega) {
    bool const coupled = by_phase != nullptr;
    std::size_t const index = coupled ? c.coupled.size() : c.rl.size();
    if (coupled) {
        double const km = l.length_km.value_or(0);
        c.coupled.push_back({emt::CoupledBranch::Kind::inductive,
                             parts.from_node,
                             parts.to_node,
                             full(by_phase->phase_r_ohm_per_km, km),
                             full(by_phase->phase_x_ohm_per_km, km / omega),
                             {}});
    } else {
        c.add_rl(parts.from_node, parts.to_node, emt::PhaseMatrix::sequence(t.r_ohm, t.r0_ohm),
                 emt::PhaseMatrix::sequence(t.l_h, t.l0_h));
    }
    parts.sections.push_back({coupled ? Section::Kind::coupled : Section::Kind::rl, static_cast<int>(index), 0, 1});
    c.flows(parts.from_switch, coupled ? Part::coupled : Part::rl, index, 1);
    c.flows(parts.to_switch, coupled ? Part::coupled : Part::rl, index, -1);
}

} // namespace

Result<void> Line::circuit(emt::Circuit& c, emt::TwoPortParts& parts, Surroundings const& around) const {
    LineType const* const by_phase = phase_type(*this, around);
    LineTotals const t = totals(around);
    if (model == LineModel::bergeron) {
        return wave(c, parts, *this, t, by_phase != nullptr);
    }
    if (LineType const* const own = type_by_frequency(*this, around)) {
        return frequency_dependent(c, parts, *this, *own, around.omega());
    }
    if (t.c_f < 0 || t.c0_f < 0) { // a shunt reactor, said so in a MATPOWER case
        return fail(ExitCode::usage, fmt::format("line '{}' has a negative capacitance", name.name),
                    "simulate with phasors, or give it none and a shunt with negative q_kvar at its ends");
    }
    series(c, parts, *this, t, by_phase, around.omega());
    if (t.c_f > 0 || t.c0_f > 0) {
        emt::PhaseMatrix const half = emt::PhaseMatrix::sequence(t.c_f / 2, t.c0_f / 2);
        for (auto const& [node, breaker] :
             {std::pair{parts.from_node, parts.from_switch}, std::pair{parts.to_node, parts.to_switch}}) {
            c.flows(breaker, Part::capacitor, static_cast<std::size_t>(c.add_capacitor(node, emt::kEarth, half)), 1);
        }
    }
    return {};
}

std::optional<Refusal> Line::refuses_fault(double percent) const {
    auto const same = [percent](double place) { return std::abs(place - percent) < 1e-7; };
    if (model != LineModel::frequency_dependent || percent <= 0 || percent >= 100 ||
        std::any_of(fault_places_percent.begin(), fault_places_percent.end(), same)) {
        return {};
    }
    return Refusal{"a frequency-dependent line is not cut while it runs",
                   "name the place in its fault_places_percent, or use `model: bergeron`"};
}

} // namespace gridspace::sim
