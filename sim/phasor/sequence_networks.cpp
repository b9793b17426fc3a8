// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/sequence_networks.hpp"

#include "sim/powerflow/sparse_lu.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace gridspace::sim::phasor {
namespace {

/// A node that nothing joins to earth has this admittance (p.u.): no current to speak of.
constexpr double kNothing = 1e-9;

class SequenceNetwork {
  public:
    SequenceNetwork(Network const& n, SwitchState const& switches, std::set<std::string> const& out, Sequence sequence)
        : n_{n}, switches_{switches}, out_{out}, sequence_{sequence}, around_{n},
          nodes_{static_cast<int>(n.buses.size())} {}

    /// Impedance to earth at the fault.
    Result<Complex> at(ApplyFault const& fault) {
        int const place = fault.line.empty() ? node_of(Ref{fault.bus, {}}) : nodes_++;
        std::vector<TwoPort const*> const elements = two_ports(n_);
        for (std::size_t i = 0; i < elements.size(); ++i) {
            TwoPort const& e = *elements[i];
            if (switches_.out[i]) {
                continue;
            }
            if (auto const pi = e.pi(around_)) {
                bool const faulted = !fault.line.empty() && e.name.name == fault.line;
                line(e, sequence_ == Sequence::zero ? pi->zero : pi->positive, faulted ? place : -1,
                     fault.position_percent / 100);
            } else {
                two_port(e);
            }
        }
        for (OnePort const* e : one_ports(n_)) {
            if (!out_.contains(e->name.name)) {
                earth(node_of(e->bus), e->sequence_pu(sequence_, around_));
            }
        }
        for (int k = 0; k < nodes_; ++k) {
            earth(k, kNothing);
        }
        Eigen::SparseMatrix<Complex> y(nodes_, nodes_);
        y.setFromTriplets(entries_.begin(), entries_.end());
        Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors{y};
        if (factors.info() != Eigen::Success) {
            return fail(ExitCode::usage, fmt::format("the {} sequence network of fault '{}' is singular",
                                                     sequence_ == Sequence::zero ? "zero" : "negative", fault.name));
        }
        Eigen::VectorXcd current = Eigen::VectorXcd::Zero(nodes_);
        current[place] = 1;
        Eigen::VectorXcd const v = factors.solve(current);
        return v[place];
    }

  private:
    int node_of(Ref const& bus) const { return static_cast<int>(around_.bus(bus)); }
    void earth(int node, Complex y) { entries_.emplace_back(node, node, y); }
    void between(int a, int b, Complex y) {
        earth(a, y);
        earth(b, y);
        entries_.emplace_back(a, b, -y);
        entries_.emplace_back(b, a, -y);
    }

    void line(TwoPort const& l, PiSection const& pi, int fault_node, double share) {
        double const base = around_.base_ohm(l.from);
        Complex const z = pi.series_ohm / base, half = pi.half_s * base;
        Ends const closed = switches_.closed(n_, l.name);
        auto const end = [&](bool is_closed, Ref const& bus) {
            int const node = is_closed ? node_of(bus) : nodes_++;
            earth(node, half);
            return node;
        };
        int const from = end(closed.from, l.from), to = end(closed.to, l.to);
        if (fault_node < 0) {
            between(from, to, 1.0 / z);
            return;
        }
        double const x = std::clamp(share, 1e-6, 1 - 1e-6);
        between(from, fault_node, 1.0 / (z * x));
        between(fault_node, to, 1.0 / (z * (1 - x)));
    }

    void two_port(TwoPort const& e) {
        Admittances const y = seen_from(e.sequence(sequence_, around_), switches_.closed(n_, e.name));
        int const from = node_of(e.from), to = node_of(e.to);
        earth(from, y.ff);
        earth(to, y.tt);
        entries_.emplace_back(from, to, y.ft);
        entries_.emplace_back(to, from, y.tf);
    }

    Network const& n_;
    SwitchState const& switches_;
    std::set<std::string> const& out_;
    Sequence sequence_;
    NetworkAround around_;
    int nodes_;
    std::vector<Eigen::Triplet<Complex>> entries_;
};

} // namespace

Result<SequenceImpedances> sequence_impedances(Network const& network, SwitchState const& switches,
                                               std::set<std::string> const& out, ApplyFault const& fault) {
    auto const z2 = SequenceNetwork{network, switches, out, Sequence::negative}.at(fault);
    if (!z2) {
        return std::unexpected{z2.error()};
    }
    auto const z0 = SequenceNetwork{network, switches, out, Sequence::zero}.at(fault);
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
