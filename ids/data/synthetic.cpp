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

/// What is drawn for a waveform before its samples; in the order of the draws.
struct Draw {
    double peak, angle, frequency, event_s, fault_peak, fault_angle, fault_tau_s, load_tau_s, share, dip, ratio, turn,
        cleared_s, swing_hz, swing_rad;
    std::size_t first_phase;
};

Draw draw(SyntheticParams const& s, Situation situation, Random& r) {
    Draw d{};
    d.peak = s.nominal_peak_a * r.uniform(s.load[0], s.load[1]);
    d.angle = r.uniform(0, kTwoPi);
    d.frequency =
        s.frequency_hz + (r.chance(s.off_nominal_share) ? r.uniform(-s.frequency_spread_hz, s.frequency_spread_hz) : 0);
    d.event_s = r.uniform(s.event_s[0], s.event_s[1]);
    d.fault_peak = s.nominal_peak_a * spread(r, s.fault);
    d.fault_angle = r.uniform(0, kTwoPi);
    // A fault current of 1/k of the bolted one flows through k times its impedance; what is added is resistance.
    double const network_ratio = r.uniform(s.x_over_r[0], s.x_over_r[1]),
                 weaker = s.nominal_peak_a * s.fault[1] / d.fault_peak;
    double const z2 = (1 + 1 / (network_ratio * network_ratio)) * weaker * weaker; // of a reactance of 1
    d.fault_tau_s = 1 / (kTwoPi * s.frequency_hz * std::max(std::sqrt(z2 - 1), 1 / network_ratio));
    d.load_tau_s = r.uniform(s.load_x_over_r[0], s.load_x_over_r[1]) / (kTwoPi * s.frequency_hz);
    d.share = r.chance(s.radial_share) ? 1.0 : r.uniform(0.1, 0.9);
    d.dip = r.uniform(0.2, 0.95);
    d.ratio = r.uniform(0.5, 1.6);
    d.turn = r.uniform(-0.5, 0.5);
    d.cleared_s = d.event_s + r.uniform(0.06, 0.15);
    d.swing_hz = situation == Situation::swing ? r.uniform(3, 5) : 0;
    d.swing_rad = situation == Situation::swing ? r.uniform(0.2, 0.8) : 0;
    d.first_phase = static_cast<std::size_t>(r.below(3));
    return d;
}

/// The load, and what the situation makes of it.
std::vector<Interval> intervals_of(Situation situation, Draw const& d) {
    std::vector<Interval> out{{0, d.load_tau_s, balanced(d.peak, d.angle), {}, 1, {}}};
    Phasors const load = out[0].phasors;
    Phasors now = load;
    switch (situation) {
    case Situation::quiet:
    case Situation::swing:
        break;
    case Situation::load_step:
    case Situation::line_trip:
    case Situation::generator_trip: {
        double const step = situation == Situation::load_step   ? d.ratio
                            : situation == Situation::line_trip ? 1 + d.ratio / 2
                                                                : 1.6 - d.ratio * 0.7;
        now = balanced(d.peak * step, d.angle + (situation == Situation::load_step ? d.turn / 2 : d.turn));
        out.push_back({d.event_s, d.load_tau_s, now, {}, 1, {}});
        break;
    }
    case Situation::external_3ph:
    case Situation::external_1ph: // through the line: the same at both ends
        for (std::size_t p = 0; p < 3; ++p) {
            if (situation == Situation::external_3ph || p == d.first_phase) {
                now[p] = now[p + 3] = polar(d.fault_peak, d.fault_angle - kTwoPi * static_cast<double>(p) / 3);
            }
        }
        out.push_back({d.event_s, d.fault_tau_s, now, {}, 1, {}});
        out.push_back(
            {d.cleared_s, d.load_tau_s, balanced(d.peak * (0.8 + d.ratio / 4), d.angle + d.turn / 4), {}, 1, {}});
        break;
    case Situation::internal_3ph:
    case Situation::internal_2ph:
    case Situation::internal_1ph: {
        Interval during{d.event_s, d.load_tau_s, load, {}, d.fault_tau_s, {}};
        unsigned const one = 1U << d.first_phase, two = one | (1U << ((d.first_phase + 1) % 3));
        unsigned const mask = situation == Situation::internal_3ph   ? 7U
                              : situation == Situation::internal_2ph ? two
                                                                     : one;
        add_fault(during, load, polar(d.fault_peak, d.fault_angle), mask, d.share, d.dip);
        out.push_back(during);
        break;
    }
    }
    return out;
}

/// The currents of the six channels over time, without what the measuring chain adds. Each interval begins with the
/// current with which the one before ends: the difference decays.
class Course {
  public:
    Course(std::vector<Interval> intervals, Draw const& d) : intervals_{std::move(intervals)}, d_{d} {
        for (std::size_t k = 1; k < intervals_.size(); ++k) {
            for (std::size_t c = 0; c < 6; ++c) {
                double const t = intervals_[k].start_s, before = value(intervals_[k - 1], c, t);
                intervals_[k].offset[c] = before - value(intervals_[k], c, t);
            }
        }
    }
    [[nodiscard]] double theta(double t) const {
        return kTwoPi * d_.frequency * t + d_.swing_rad * elementary::sin(kTwoPi * d_.swing_hz * t);
    }
    /// Times must not go back.
    void go_to(double t) {
        while (at_ + 1 < intervals_.size() && intervals_[at_ + 1].start_s <= t) {
            ++at_;
        }
    }
    [[nodiscard]] double value(std::size_t c, double t) const { return value(intervals_[at_], c, t); }

  private:
    [[nodiscard]] double value(Interval const& i, std::size_t c, double t) const {
        Complex const turn_t = polar(1, theta(t));
        double out_a = (i.phasors[c] * turn_t).real() + i.offset[c] * elementary::exp(-(t - i.start_s) / i.tau_s);
        if (i.fault[c] != Complex{}) {
            out_a += (i.fault[c] * turn_t).real() - (i.fault[c] * polar(1, theta(i.start_s))).real() *
                                                        elementary::exp(-(t - i.start_s) / i.fault_tau_s);
        }
        return out_a;
    }

    std::vector<Interval> intervals_;
    Draw d_;
    std::size_t at_{0};
};

/// What the network and the measuring chain add to a current.
struct Disturbance {
    struct Harmonic {
        double order, amplitude, angle;
    };
    std::array<Harmonic, 3> harmonics{};
    std::array<double, 6> gain{};
    double noise_a{0};

    Disturbance(SyntheticParams const& s, double peak, Random& r) {
        for (std::size_t k = 0; k < 3; ++k) {
            harmonics[k] = {3.0 + 2 * static_cast<double>(k), peak * r.uniform(0, s.harmonics_percent) / 100,
                            r.uniform(0, kTwoPi)};
        }
        for (double& g : gain) {
            g = 1 + s.ct_error_percent / 100 * r.normal();
        }
        noise_a = s.nominal_peak_a * r.uniform(s.noise_percent[0], s.noise_percent[1]) / 100;
    }
};

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

    Draw const drawn = draw(s, situation, r);
    std::vector<Interval> intervals = intervals_of(situation, drawn);
    if (intervals.size() > 1) {
        out.event = static_cast<std::int64_t>(std::ceil(drawn.event_s * s.rate_hz));
    }
    Course course{std::move(intervals), drawn};
    Disturbance const added{s, drawn.peak, r};

    auto const count = static_cast<std::size_t>(s.duration_s * s.rate_hz);
    out.from.resize(count);
    out.to.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        double const t = static_cast<double>(n) / s.rate_hz;
        course.go_to(t);
        for (std::size_t c = 0; c < 6; ++c) {
            double i = course.value(c, t);
            for (Disturbance::Harmonic const& h : added.harmonics) {
                i += h.amplitude *
                     elementary::cos(h.order * (course.theta(t) - kTwoPi * static_cast<double>(c % 3) / 3) + h.angle);
            }
            i = i * added.gain[c] + added.noise_a * r.normal();
            i = s.quantum_a > 0 ? std::floor(i / s.quantum_a + 0.5) * s.quantum_a : i;
            (c < 3 ? out.from : out.to)[n][c % 3] = i;
        }
    }
    return out;
}

} // namespace gridspace::ids
