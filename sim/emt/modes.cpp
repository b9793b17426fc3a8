// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/modes.hpp"

#include "sim/emt/mode_elements.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;
using Vector = Eigen::VectorXd;

constexpr int kLanczosSteps = 80;
/// Modes that are looked at before it is said that none rings.
constexpr int kMaxTried = 12;
/// Share of the damping in s of what falls to a tenth within a period: ln 10 / sqrt((2 pi)^2 + (ln 10)^2).
constexpr double kRingsBelow = 0.344;
/// Newton's method is given up when it moves a mode further.
constexpr double kLargestCorrection = 0.5;
/// Ties between two nodes without inductance are taken as their resistance at this angular frequency.
constexpr double kTieOmega = 2 * std::numbers::pi * 1e4;

/// From its conductance in two step lengths.
NortonImpedance behind(NortonElement const& element) {
    constexpr double kShort = 1e-6, kLong = 2e-6;
    PhaseMatrix const a = element.conductance(kShort), b = element.conductance(kLong);
    auto const split = [&](double ga, double gb) { // 1/g = r + 2 l / h
        if (!(ga > 0) || !(gb > 0)) {
            return std::pair{0.0, 0.0};
        }
        double const l = (1 / ga - 1 / gb) / (2 / kShort - 2 / kLong);
        return std::pair{std::max(1 / ga - 2 * l / kShort, 0.0), l};
    };
    auto const [r1, l1] = split(a.one, b.one);
    auto const [r0, l0] = split(a.zero(), b.zero());
    return {PhaseMatrix::sequence(r1, r0), PhaseMatrix::sequence(l1, l0)};
}

double inverse_or_none(double x) {
    return x > 0 ? 1 / x : 0;
}

/// Inverse inductances of all elements; capacitances stay out.
Admittances<double> inverse_inductances(Circuit const& c) {
    Admittances<double> y;
    for (RlBranch const& b : c.rl) {
        bool const tie = b.from != kEarth && b.to != kEarth && b.l.one == 0 && b.l.mutual == 0;
        y.rl.push_back(
            tie ? PhaseMatrix::sequence(kTieOmega * inverse_or_none(b.r.one), kTieOmega * inverse_or_none(b.r.zero()))
                : PhaseMatrix::sequence(inverse_or_none(b.l.one), inverse_or_none(b.l.zero())));
    }
    y.capacitors.resize(c.capacitors.size());
    for (CoupledBranch const& b : c.coupled) {
        y.coupled.push_back(b.kind == CoupledBranch::Kind::capacitive || no_inductance(b.l) ? Matrix3{} : inverse(b.l));
    }
    for (NortonPort const& p : c.norton) {
        PhaseMatrix const l = behind(*p.element).l;
        y.norton.push_back(PhaseMatrix::sequence(inverse_or_none(l.one), inverse_or_none(l.zero())));
    }
    y.bergeron.resize(c.bergeron.size());
    y.marti.resize(c.marti.size());
    for (Winding const& w : c.windings) {
        y.windings.push_back(inverse_or_none(w.l));
    }
    for (SaturableCore const& core : c.cores) {
        y.cores.push_back(inverse_or_none(core.l));
    }
    return y;
}

Admittances<double> capacitances(Circuit const& c) {
    Admittances<double> y;
    y.rl.resize(c.rl.size());
    for (CapacitorBranch const& b : c.capacitors) {
        y.capacitors.push_back(b.c);
    }
    for (CoupledBranch const& b : c.coupled) {
        y.coupled.push_back(b.kind == CoupledBranch::Kind::capacitive ? b.c : Matrix3{});
    }
    y.norton.resize(c.norton.size());
    y.bergeron.resize(c.bergeron.size());
    y.marti.resize(c.marti.size());
    y.windings.resize(c.windings.size());
    y.cores.resize(c.cores.size());
    return y;
}

/// All elements at the complex frequency s.
Admittances<Complex> admittances_at(Circuit const& c, std::vector<NortonImpedance> const& norton, Complex s) {
    auto const inverse_of = [&](double r, double l) { return r == 0 && l == 0 ? Complex{} : 1.0 / (r + s * l); };
    auto const branch = [&](PhaseMatrix const& r, PhaseMatrix const& l) {
        return ComplexPhaseMatrix::sequence(inverse_of(r.one, l.one), inverse_of(r.zero(), l.zero()));
    };
    Admittances<Complex> y;
    for (RlBranch const& b : c.rl) {
        y.rl.push_back(branch(b.r, b.l));
    }
    for (CapacitorBranch const& b : c.capacitors) {
        y.capacitors.push_back(ComplexPhaseMatrix::sequence(s * b.c.one, s * b.c.zero()));
    }
    for (CoupledBranch const& b : c.coupled) {
        Matrix3Of<Complex> m{};
        bool const capacitive = b.kind == CoupledBranch::Kind::capacitive;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                m[i][j] = capacitive ? s * b.c[i][j] : b.r[i][j] + s * b.l[i][j];
            }
        }
        y.coupled.push_back(capacitive ? m : inverse(m));
    }
    for (NortonImpedance const& b : norton) {
        y.norton.push_back(branch(b.r, b.l));
    }
    for (BergeronLine const& b : c.bergeron) {
        y.bergeron.push_back(ComplexPhaseMatrix::sequence(1 / (b.z1 + b.r1 / 4), 1 / (b.z0 + b.r0 / 4)));
    }
    for (MartiLine const& b : c.marti) {
        y.marti.push_back(ComplexPhaseMatrix::sequence(1.0 / b.positive.impedance.at(s), 1.0 / b.zero.impedance.at(s)));
    }
    for (Winding const& w : c.windings) {
        y.windings.push_back(inverse_of(w.r, w.l));
    }
    for (SaturableCore const& core : c.cores) {
        y.cores.push_back(inverse_of(0, core.l));
    }
    return y;
}

/// A symmetric matrix whose unknowns are numbered anew; those without a number are left out.
void multiply(std::vector<Entry<double>> const& entries, Vector const& x, Vector& out) {
    out.setZero();
    for (auto const& e : entries) {
        out[e.row] += e.value * x[e.column];
        if (e.row != e.column) {
            out[e.column] += e.value * x[e.row];
        }
    }
}

/// K v = w^2 C v over the nodes that hold charge; the others follow from K alone.
class LosslessModes {
  public:
    LosslessModes(Circuit const& c, Topology const& t, SwitchBits const& bits, ModeSearch const& search)
        : n_{t.unknowns}, k_{assemble(c, t, bits, inverse_inductances(c)).matrix} {
        auto const all = assemble(c, t, bits, capacitances(c)).matrix;
        std::vector<double> own(static_cast<std::size_t>(n_)), peak_v(static_cast<std::size_t>(n_));
        for (auto const& e : all) {
            if (e.row == e.column) {
                own[static_cast<std::size_t>(e.row)] += e.value;
            }
        }
        for (std::size_t node = 0; node < t.slot.size(); ++node) {
            if (t.slot[node] < n_) {
                double& v = peak_v[static_cast<std::size_t>(t.slot[node])];
                v = std::max(v, search.peak_v[node]);
            }
        }
        double const w0 = 2 * std::numbers::pi * c.frequency_hz;
        place_.assign(own.size(), -1);
        int rest = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
            holds_.push_back(own[i] > 0 && w0 * own[i] * peak_v[i] * peak_v[i] / 2 >= search.least_var);
            place_[i] = holds_.back() ? charged_++ : rest++;
        }
        std::vector<Entry<double>> inside;
        for (auto const& e : k_) {
            auto const i = static_cast<std::size_t>(e.row), j = static_cast<std::size_t>(e.column);
            if (!holds_[i] && !holds_[j]) {
                inside.push_back({std::min(place_[i], place_[j]), std::max(place_[i], place_[j]), e.value});
            }
        }
        (void)inside_.factor(rest, inside);
        for (auto const& e : all) {
            auto const i = static_cast<std::size_t>(e.row), j = static_cast<std::size_t>(e.column);
            if (holds_[i] && holds_[j]) {
                c_.push_back({std::min(place_[i], place_[j]), std::max(place_[i], place_[j]), e.value});
            }
        }
        (void)charge_.factor(charged_, c_);
    }

    struct Found {
        double omega{0};
        Vector v; ///< over all unknowns
    };
    /// The fastest ones, in falling order.
    [[nodiscard]] std::vector<Found> fastest() const {
        std::vector<Found> out;
        int const most = std::min(charged_, kLanczosSteps);
        std::vector<Vector> q, cq;
        std::vector<double> alpha, beta;
        Vector x(charged_), full(n_), image(n_), w(charged_);
        for (int i = 0; i < charged_; ++i) { // any vector that no mode is orthogonal to
            x[i] = 1 + 0.5 * std::sin(1.0 + 2.399963 * i);
        }
        for (int m = 0; m < most; ++m) {
            Vector cx(charged_);
            multiply(c_, x, cx);
            double const norm = std::sqrt(x.dot(cx));
            if (m > 0) {
                beta.push_back(norm);
            }
            if (!(norm > (m == 0 ? 0 : 1e-10 * scale(alpha)))) {
                break;
            }
            q.push_back(x / norm);
            cq.push_back(cx / norm);
            expand(q.back(), full);
            multiply(k_, full, image);
            for (int i = 0; i < n_; ++i) {
                if (holds_[static_cast<std::size_t>(i)]) {
                    w[place_[static_cast<std::size_t>(i)]] = image[i];
                }
            }
            charge_.solve(w.data());
            alpha.push_back(w.dot(cq.back()));
            for (int pass = 0; pass < 2; ++pass) { // orthogonal to all so far, to rounding
                for (std::size_t j = 0; j < q.size(); ++j) {
                    w -= w.dot(cq[j]) * q[j];
                }
            }
            x = w;
        }
        auto const size = static_cast<Eigen::Index>(alpha.size());
        if (size == 0) {
            return out;
        }
        Vector const diagonal = Vector::Map(alpha.data(), size);
        Vector const off = Vector::Map(beta.data(), std::max<Eigen::Index>(size - 1, 0));
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
        solver.computeFromTridiagonal(diagonal, off);
        for (Eigen::Index i = size; i-- > 0 && out.size() < kMaxTried;) {
            double const square = solver.eigenvalues()[i];
            if (!(square > 0)) {
                break;
            }
            Vector shape = Vector::Zero(charged_);
            for (Eigen::Index j = 0; j < size; ++j) {
                shape += solver.eigenvectors()(j, i) * q[static_cast<std::size_t>(j)];
            }
            expand(shape, full);
            out.push_back({std::sqrt(square), full});
        }
        return out;
    }

  private:
    static double scale(std::vector<double> const& alpha) {
        double out = 0;
        for (double const a : alpha) {
            out = std::max(out, std::abs(a));
        }
        return out;
    }
    /// Voltages of all unknowns from those of the nodes that hold charge.
    void expand(Vector const& x, Vector& full) const {
        for (int i = 0; i < n_; ++i) {
            auto const u = static_cast<std::size_t>(i);
            full[i] = holds_[u] ? x[place_[u]] : 0;
        }
        Vector image(n_), rest(n_ - charged_);
        multiply(k_, full, image);
        for (int i = 0; i < n_; ++i) {
            auto const u = static_cast<std::size_t>(i);
            if (!holds_[u]) {
                rest[place_[u]] = -image[i];
            }
        }
        inside_.solve(rest.data());
        for (int i = 0; i < n_; ++i) {
            auto const u = static_cast<std::size_t>(i);
            if (!holds_[u]) {
                full[i] = rest[place_[u]];
            }
        }
    }

    int n_, charged_{0};
    std::vector<bool> holds_;
    std::vector<int> place_; ///< by unknown: among those that hold charge, or among the rest
    std::vector<Entry<double>> k_, c_;
    Ldlt<double> inside_, charge_;
};

/// v' A v and the pieces of it.
Complex form(std::vector<Entry<Complex>> const& a, std::vector<Complex> const& v) {
    Complex sum{};
    for (auto const& e : a) {
        Complex const term = e.value * v[static_cast<std::size_t>(e.row)] * v[static_cast<std::size_t>(e.column)];
        sum += e.row == e.column ? term : 2.0 * term;
    }
    return sum;
}

/// Newton's method on Y(s) v = 0 with the Rayleigh functional and inverse iteration for v. Where it leads away, losses
/// are large, or there are others close by: its first step says whether it rings, then without losses. Nothing when it
/// does not.
std::optional<Damped> with_losses(Circuit const& c, Topology const& t, SwitchBits const& bits,
                                  std::vector<NortonImpedance> const& norton, LosslessModes::Found const& from) {
    Damped mode{{0, from.omega}, {from.v.begin(), from.v.end()}};
    Damped const lossless = mode;
    std::optional<Damped> otherwise;
    auto const matrix = [&](Complex s) { return assemble(c, t, bits, admittances_at(c, norton, s)).matrix; };
    for (int round = 0; round < 20; ++round) {
        Complex const delta = 1e-4 * mode.s;
        auto const before = matrix(mode.s - delta), here = matrix(mode.s), after = matrix(mode.s + delta);
        Complex const slope = (form(after, mode.v) - form(before, mode.v)) / (2.0 * delta);
        Complex const change = -form(here, mode.v) / slope;
        if (round == 0 && std::abs(change) < kRingsBelow * from.omega) {
            otherwise = lossless;
        }
        mode.s += change;
        if (!(std::abs(mode.s - Complex{0, from.omega}) < kLargestCorrection * from.omega)) { // true for NaN
            return otherwise;
        }
        if (std::abs(change) < 1e-7 * std::abs(mode.s)) {
            return -mode.s.real() < kRingsBelow * std::abs(mode.s) ? std::optional{mode} : std::nullopt;
        }
        Ldlt<Complex> factors;
        (void)factors.factor(t.unknowns, matrix(mode.s));
        std::vector<Complex> right(mode.v.size());
        auto const add = [&](std::vector<Entry<Complex>> const& a, double sign) {
            for (auto const& e : a) {
                auto const i = static_cast<std::size_t>(e.row), j = static_cast<std::size_t>(e.column);
                right[i] += sign * e.value * mode.v[j];
                if (i != j) {
                    right[j] += sign * e.value * mode.v[i];
                }
            }
        };
        add(after, 1);
        add(before, -1);
        factors.solve(right.data());
        double largest = 0;
        for (Complex const& x : right) {
            largest = std::max(largest, std::abs(x));
        }
        if (!(largest > 0)) {
            return otherwise;
        }
        for (std::size_t i = 0; i < right.size(); ++i) {
            mode.v[i] = right[i] / largest;
        }
    }
    return otherwise;
}

} // namespace

SwitchBits switch_state(Circuit const& c, bool all_closed) {
    SwitchBits bits;
    for (Switch const& s : c.switches) {
        bits.closed.push_back(all_closed ? std::array{true, true, true} : s.closed);
    }
    bits.faulted.resize(c.faults.size(), {false, false, false});
    bits.segment.resize(c.cores.size(), 0);
    return bits;
}

Result<std::optional<Mode>> fastest_mode(Circuit const& c, SwitchBits const& bits, ModeSearch const& search) {
    auto const topology = make_topology(c, bits);
    if (!topology) {
        return std::unexpected{topology.error()};
    }
    std::vector<NortonImpedance> norton;
    for (NortonPort const& p : c.norton) {
        norton.push_back(behind(*p.element));
    }
    std::optional<Mode> out;
    for (auto const& found : LosslessModes{c, *topology, bits, search}.fastest()) {
        if (out && found.omega <= 2 * std::numbers::pi * out->frequency_hz) {
            break; // losses have slowed the one before; this cannot be faster
        }
        auto const mode = with_losses(c, *topology, bits, norton, found);
        double const hz = mode ? std::abs(mode->s.imag()) / (2 * std::numbers::pi) : 0;
        if (hz > (out ? out->frequency_hz : 0)) {
            out = Mode{hz, -mode->s.real(), mode_elements(c, *topology, norton, *mode)};
        }
    }
    return out;
}

} // namespace gridspace::sim::emt
