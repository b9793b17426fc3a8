// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/sequence_networks.hpp"

#include "sim/machines/machine_data.hpp"

#include <Eigen/SparseLU>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace gridspace::sim::phasor {
namespace {

/// A node that nothing joins to earth has this admittance (p.u.): no current to speak of.
constexpr double kNothing = 1e-9;
/// An ideal source.
constexpr double kStiff = 1e9;

class SequenceNetwork {
  public:
    SequenceNetwork(Network const& n, SwitchState const& switches, std::set<std::string> const& out, bool zero)
        : n_{n}, switches_{switches}, out_{out}, zero_{zero}, omega_{2 * std::numbers::pi * n.frequency_hz},
          nodes_{static_cast<int>(n.buses.size())} {}

    /// Impedance to earth at the fault.
    Result<Complex> at(ApplyFault const& fault) {
        int const place = fault.line.empty() ? node_of(fault.bus) : nodes_++;
        for (std::size_t i = 0; i < n_.lines.size(); ++i) {
            if (!switches_.line_out[i]) {
                bool const faulted = !fault.line.empty() && n_.lines[i].name.name == fault.line;
                line(n_.lines[i], faulted ? place : -1, fault.position_percent / 100);
            }
        }
        for (std::size_t i = 0; i < n_.transformers.size(); ++i) {
            if (!switches_.transformer_out[i]) {
                transformer(n_.transformers[i]);
            }
        }
        units();
        for (int k = 0; k < nodes_; ++k) {
            earth(k, kNothing);
        }
        Eigen::SparseMatrix<Complex> y(nodes_, nodes_);
        y.setFromTriplets(entries_.begin(), entries_.end());
        Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors{y};
        if (factors.info() != Eigen::Success) {
            return fail(ExitCode::usage, fmt::format("the {} sequence network of fault '{}' is singular",
                                                     zero_ ? "zero" : "negative", fault.name));
        }
        Eigen::VectorXcd current = Eigen::VectorXcd::Zero(nodes_);
        current[place] = 1;
        Eigen::VectorXcd const v = factors.solve(current);
        return v[place];
    }

  private:
    int node_of(std::string const& bus) const { return static_cast<int>(index_of(n_.buses, bus)); }
    double base_of(Ref const& bus) const { return base_impedance(n_, n_.buses[index_of(n_.buses, bus.name)]); }
    bool out(Ref const& name) const { return out_.contains(name.name); }
    void earth(int node, Complex y) { entries_.emplace_back(node, node, y); }
    void between(int a, int b, Complex y) {
        earth(a, y);
        earth(b, y);
        entries_.emplace_back(a, b, -y);
        entries_.emplace_back(b, a, -y);
    }

    void line(Line const& l, int fault_node, double share) {
        LineTotals const t = line_totals(n_, l);
        double const base = base_of(l.from);
        Complex const z = (zero_ ? Complex{t.r0_ohm, omega_ * t.l0_h} : Complex{t.r_ohm, omega_ * t.l_h}) / base;
        Complex const half{0, omega_ * (zero_ ? t.c0_f : t.c_f) / 2 * base};
        auto const end = [&](LineEnd which, Ref const& bus) {
            int const node = switches_.closed(n_, l.name.name, which) ? node_of(bus.name) : nodes_++;
            earth(node, half);
            return node;
        };
        int const from = end(LineEnd::from, l.from), to = end(LineEnd::to, l.to);
        if (fault_node < 0) {
            between(from, to, 1.0 / z);
            return;
        }
        double const x = std::clamp(share, 1e-6, 1 - 1e-6);
        between(from, fault_node, 1.0 / (z * x));
        between(fault_node, to, 1.0 / (z * (1 - x)));
    }

    void transformer(Transformer const& t) {
        double const scale = t.rating_kva / n_.power_kva;
        Complex const y = 100.0 / Complex{t.r_percent, t.x_percent} * scale;
        Complex const half{0, t.charging_percent / 200 * scale};
        Complex const magnetising{0, -t.magnetising_percent / 100 * scale};
        int const from = node_of(t.from.name), to = node_of(t.to.name);
        double const a = t.tap_ratio;
        if (!zero_) {
            Complex const tap = std::polar(a, -t.phase_shift_deg * std::numbers::pi / 180); // the other way round
            earth(from, (y + half + magnetising) / (a * a));
            earth(to, y + half);
            entries_.emplace_back(from, to, -y / std::conj(tap));
            entries_.emplace_back(to, from, -y / tap);
            return;
        }
        bool const from_earthed = t.from_winding == Winding::wye_grounded;
        bool const to_earthed = t.to_winding == Winding::wye_grounded;
        if (from_earthed) {
            earth(from, (half + magnetising) / (a * a));
        }
        if (to_earthed) {
            earth(to, half);
        }
        if (from_earthed && to_earthed) {
            earth(from, y / (a * a));
            earth(to, y);
            entries_.emplace_back(from, to, -y / a);
            entries_.emplace_back(to, from, -y / a);
        } else if (from_earthed && t.to_winding == Winding::delta) {
            earth(from, y / (a * a));
        } else if (to_earthed && t.from_winding == Winding::delta) {
            earth(to, y);
        }
    }

    void units() {
        for (Source const& s : n_.sources) {
            double const r = zero_ ? s.r0_ohm.value_or(s.r_ohm) : s.r_ohm;
            double const l = zero_ ? s.l0_mh.value_or(s.l_mh) : s.l_mh;
            Complex const z{r, omega_ * l * 1e-3};
            earth(node_of(s.bus.name), z == Complex{} ? Complex{kStiff} : base_of(s.bus) / z);
        }
        for (Generator const& g : n_.generators) {
            if (g.role == GeneratorRole::slack) {
                earth(node_of(g.bus.name), kStiff);
            }
        }
        for (Machine const& m : n_.machines) {
            machines::MachineData const d = machines::machine_data(n_, m);
            if (out(m.name) || (zero_ && d.x0 <= 0)) {
                continue;
            }
            earth(node_of(m.bus.name), m.rating_kva / n_.power_kva / Complex{d.ra, zero_ ? d.x0 : d.x2()});
        }
        for (OnePort const* e : one_ports(n_)) {
            if (!out(e->name)) {
                earth(node_of(e->bus.name), e->admittance_kva(find(n_.buses, e->bus.name)->voltage_v) / n_.power_kva);
            }
        }
    }

    Network const& n_;
    SwitchState const& switches_;
    std::set<std::string> const& out_;
    bool zero_;
    double omega_;
    int nodes_;
    std::vector<Eigen::Triplet<Complex>> entries_;
};

} // namespace

Result<SequenceImpedances> sequence_impedances(Network const& network, SwitchState const& switches,
                                               std::set<std::string> const& out, ApplyFault const& fault) {
    auto const z2 = SequenceNetwork{network, switches, out, false}.at(fault);
    if (!z2) {
        return std::unexpected{z2.error()};
    }
    auto const z0 = SequenceNetwork{network, switches, out, true}.at(fault);
    if (!z0) {
        return std::unexpected{z0.error()};
    }
    return SequenceImpedances{*z2, *z0};
}

Complex positive_sequence_fault(FaultType type, SequenceImpedances const& z, double r) {
    switch (type) {
    case FaultType::phase_ground:
        return z.z2 + z.z0 + 3 * r;
    case FaultType::phase_phase:
        return z.z2 + 2 * r;
    case FaultType::phase_phase_ground:
        return r + (z.z2 + r) * (z.z0 + r) / (z.z2 + z.z0 + 2 * r);
    case FaultType::three_phase:
    case FaultType::three_phase_ground:
        break;
    }
    return r;
}

} // namespace gridspace::sim::phasor
