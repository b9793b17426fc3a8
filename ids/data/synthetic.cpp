// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/data/synthetic.hpp"

#include "common/elementary.hpp"
#include "common/random.hpp"

#include <cmath>
#include <complex>

namespace gridspace::ids {
namespace {

using Complex = std::complex<double>;
using Phasors = std::array<Complex, 6>; ///< peak; from a b c, to a b c; along the line
constexpr double kTwoPi = 6.283185307179586;

Complex polar(double magnitude, double angle) {
    return {magnitude * elementary::cos(angle), magnitude * elementary::sin(angle)};
}

struct Interval {
    double start_s{0}, tau_s{1};
    Phasors phasors{};
    std::array<double, 6> offset{};
    double fault_tau_s{1};
    Phasors fault{}; ///< the part of the current that flows into a fault; it starts from zero
};

Phasors balanced(double peak, double angle) {
    Phasors out;
    for (std::size_t p = 0; p < 3; ++p) {
        out[p] = out[p + 3] = polar(peak, angle - kTwoPi * static_cast<double>(p) / 3);
    }
    return out;
}

/// Log-uniform: fault currents span decades.
double spread(Random& r, std::array<double, 2> const& range) {
    return range[0] * elementary::exp(r.uniform() * elementary::log(range[1] / range[0]));
}

/// Adds a fault current to the phases of `mask`; `from_share` of it comes from the `from` end. Those of a radial line
/// lose their load at the far end.
void add_fault(Interval& out, Phasors const& load, Complex fault, unsigned mask, double from_share, double dip) {
    for (std::size_t p = 0; p < 3; ++p) {
        if ((mask & (1U << p)) == 0) {
            continue;
        }
        bool const second_of_two = (mask & (mask - 1)) != 0 && mask != 7U && (mask & ((1U << p) - 1)) != 0;
        Complex const turned = mask == 7U      ? fault * polar(1, -kTwoPi * static_cast<double>(p) / 3)
                               : second_of_two ? -fault
                                               : fault;
        out.phasors[p] = load[p] * (1 - dip);
        out.phasors[p + 3] = load[p + 3] * (1 - dip);
        out.fault[p] = turned * from_share;
        out.fault[p + 3] = -turned * (1 - from_share);
    }
}

} // namespace

char const* name_of(Situation s) {
    switch (s) {
    case Situation::quiet:
        return "quiet";
    case Situation::load_step:
        return "load_step";
    case Situation::line_trip:
        return "line_trip";
    case Situation::generator_trip:
        return "generator_trip";
    case Situation::swing:
        return "swing";
    case Situation::external_3ph:
        return "external_3ph";
    case Situation::external_1ph:
        return "external_1ph";
    case Situation::internal_3ph:
        return "internal_3ph";
    case Situation::internal_2ph:
        return "internal_2ph";
    case Situation::internal_1ph:
        return "internal_1ph";
    }
    return "?";
}

LineWaveform synthesise(SyntheticParams const& s, Situation situation, std::uint64_t seed, std::uint64_t number) {
    Random r{seed, number};
    LineWaveform out;
    out.name = std::string{name_of(situation)} + "_" + std::to_string(number);
    out.rate_hz = s.rate_hz;
    out.frequency_hz = s.frequency_hz;
    out.situation = situation;

    double const peak = s.nominal_peak_a * r.uniform(s.load[0], s.load[1]), angle = r.uniform(0, kTwoPi);
    double const frequency =
        s.frequency_hz + (r.chance(s.off_nominal_share) ? r.uniform(-s.frequency_spread_hz, s.frequency_spread_hz) : 0);
    double const event_s = r.uniform(s.event_s[0], s.event_s[1]);
    double const fault_peak = s.nominal_peak_a * spread(r, s.fault), fault_angle = r.uniform(0, kTwoPi);
    // A fault current of 1/k of the bolted one flows through k times its impedance; what is added is resistance.
    double const network_ratio = r.uniform(s.x_over_r[0], s.x_over_r[1]),
                 weaker = s.nominal_peak_a * s.fault[1] / fault_peak;
    double const z2 = (1 + 1 / (network_ratio * network_ratio)) * weaker * weaker; // of a reactance of 1
    double const fault_tau_s = 1 / (kTwoPi * s.frequency_hz * std::max(std::sqrt(z2 - 1), 1 / network_ratio));
    double const load_tau_s = r.uniform(s.load_x_over_r[0], s.load_x_over_r[1]) / (kTwoPi * s.frequency_hz);
    double const share = r.chance(s.radial_share) ? 1.0 : r.uniform(0.1, 0.9), dip = r.uniform(0.2, 0.95);
    double const ratio = r.uniform(0.5, 1.6), turn = r.uniform(-0.5, 0.5), cleared_s = event_s + r.uniform(0.06, 0.15);
    double const swing_hz = situation == Situation::swing ? r.uniform(3, 5) : 0,
                 swing_rad = situation == Situation::swing ? r.uniform(0.2, 0.8) : 0;
    auto const first_phase = static_cast<unsigned>(r.below(3));

    std::vector<Interval> intervals{{0, load_tau_s, balanced(peak, angle), {}, 1, {}}};
    Phasors const load = intervals[0].phasors;
    Phasors now = load;
    unsigned const one = 1U << first_phase, two = one | (1U << ((first_phase + 1) % 3));
    switch (situation) {
    case Situation::quiet:
    case Situation::swing:
        break;
    case Situation::load_step:
    case Situation::line_trip:
    case Situation::generator_trip: {
        double const step = situation == Situation::load_step   ? ratio
                            : situation == Situation::line_trip ? 1 + ratio / 2
                                                                : 1.6 - ratio * 0.7;
        now = balanced(peak * step, angle + (situation == Situation::load_step ? turn / 2 : turn));
        intervals.push_back({event_s, load_tau_s, now, {}, 1, {}});
        break;
    }
    case Situation::external_3ph:
    case Situation::external_1ph: // through the line: the same at both ends
        for (std::size_t p = 0; p < 3; ++p) {
            if (situation == Situation::external_3ph || p == first_phase) {
                now[p] = now[p + 3] = polar(fault_peak, fault_angle - kTwoPi * static_cast<double>(p) / 3);
            }
        }
        intervals.push_back({event_s, fault_tau_s, now, {}, 1, {}});
        intervals.push_back({cleared_s, load_tau_s, balanced(peak * (0.8 + ratio / 4), angle + turn / 4), {}, 1, {}});
        break;
    case Situation::internal_3ph:
    case Situation::internal_2ph:
    case Situation::internal_1ph: {
        Interval during{event_s, load_tau_s, load, {}, fault_tau_s, {}};
        unsigned const mask = situation == Situation::internal_3ph   ? 7U
                              : situation == Situation::internal_2ph ? two
                                                                     : one;
        add_fault(during, load, polar(fault_peak, fault_angle), mask, share, dip);
        intervals.push_back(during);
        break;
    }
    }
    if (intervals.size() > 1) {
        out.event = static_cast<std::int64_t>(std::ceil(event_s * s.rate_hz));
    }

    auto theta = [&](double t) { return kTwoPi * frequency * t + swing_rad * elementary::sin(kTwoPi * swing_hz * t); };
    auto value = [&](Interval const& i, std::size_t c, double t) {
        Complex const turn_t = polar(1, theta(t));
        double out_a = (i.phasors[c] * turn_t).real() + i.offset[c] * elementary::exp(-(t - i.start_s) / i.tau_s);
        if (i.fault[c] != Complex{}) {
            out_a += (i.fault[c] * turn_t).real() - (i.fault[c] * polar(1, theta(i.start_s))).real() *
                                                        elementary::exp(-(t - i.start_s) / i.fault_tau_s);
        }
        return out_a;
    };
    for (std::size_t k = 1; k < intervals.size(); ++k) {
        for (std::size_t c = 0; c < 6; ++c) {
            double const t = intervals[k].start_s, before = value(intervals[k - 1], c, t);
            intervals[k].offset[c] = before - value(intervals[k], c, t);
        }
    }

    struct Harmonic {
        double order, amplitude, angle;
    };
    std::array<Harmonic, 3> harmonics{};
    for (std::size_t k = 0; k < 3; ++k) {
        harmonics[k] = {3.0 + 2 * static_cast<double>(k), peak * r.uniform(0, s.harmonics_percent) / 100,
                        r.uniform(0, kTwoPi)};
    }
    std::array<double, 6> gain{};
    for (double& g : gain) {
        g = 1 + s.ct_error_percent / 100 * r.normal();
    }
    double const noise_a = s.nominal_peak_a * r.uniform(s.noise_percent[0], s.noise_percent[1]) / 100;

    auto const count = static_cast<std::size_t>(s.duration_s * s.rate_hz);
    out.from.resize(count);
    out.to.resize(count);
    std::size_t at = 0;
    for (std::size_t n = 0; n < count; ++n) {
        double const t = static_cast<double>(n) / s.rate_hz;
        while (at + 1 < intervals.size() && intervals[at + 1].start_s <= t) {
            ++at;
        }
        for (std::size_t c = 0; c < 6; ++c) {
            double i = value(intervals[at], c, t);
            for (Harmonic const& h : harmonics) {
                i += h.amplitude *
                     elementary::cos(h.order * (theta(t) - kTwoPi * static_cast<double>(c % 3) / 3) + h.angle);
            }
            i = i * gain[c] + noise_a * r.normal();
            i = s.quantum_a > 0 ? std::floor(i / s.quantum_a + 0.5) * s.quantum_a : i;
            (c < 3 ? out.from : out.to)[n][c % 3] = i;
        }
    }
    return out;
}

} // namespace gridspace::ids
