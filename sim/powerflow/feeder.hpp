// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/powerflow/three_phase.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <array>
#include <map>
#include <optional>

namespace gridspace::sim {

/// The inside of the three-phase power flow. feeder.cpp makes the admittance matrix of the network, three_phase.cpp
/// iterates.
class Feeder : private PowerFlowFace, private PhaseNetworkFace {
  public:
    Feeder(Network const& n, SwitchState const& state);
    Result<ThreePhaseFlow> solve(ThreePhaseOptions const& options);

  private:
    using Matrix3 = Eigen::Matrix3cd;
    struct DrawnPower {
        int node{0};
        double rated_v{0}; ///< phase to earth
        VoltageDependent const* load{nullptr};
        double scale{1};
        /// Nominal power of a phase, VA.
        [[nodiscard]] Complex nominal(int k) const {
            Complex const kva = load->nominal_kva(static_cast<std::size_t>(k));
            double const times = 1e3 * scale;
            return {kva.real() * times, kva.imag() * times};
        }
    };
    /// The current y (weights . voltages of the nodes) flows, times its weight, out of each node.
    struct Limb {
        std::size_t element; ///< of two_ports(network)
        Complex y;
        std::array<int, 4> nodes;
        std::array<double, 4> weights;
    };
    struct Series {
        std::size_t element;
        Matrix3 y, shunt;
        int from, to;
    };

    // what elements at one bus are
    void source(Ref const& bus, IdealSource const& source) override;
    void regulate(Ref const& bus, Regulation const& regulation) override;
    void inject(Ref const& bus, Complex kva) override { converters_.emplace_back(node(bus), kva); }
    void admit(Ref const& bus, Complex kva) override;
    void draw(Ref const& bus, VoltageDependent const& load, double scale) override {
        loads_.push_back({node(bus), phase_v_[around_.bus(bus)], &load, scale});
    }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return around_.voltage_v(bus); }
    [[nodiscard]] double omega() const override { return around_.omega(); }
    [[nodiscard]] double scale(Ref const& profile) const override {
        return profile_value(n_, profile, hours_, start_hour_of_day_);
    }
    // what two-ports are
    void series(PhaseBlock const& z_ohm, PhaseBlock const& shunt_s) override;
    void limb(Complex y, std::array<int, 4> const& nodes, std::array<double, 4> const& weights) override;
    [[nodiscard]] int node(Ref const& bus) const override { return static_cast<int>(3 * around_.bus(bus)); }
    [[nodiscard]] int add_node() override { return nodes_++; }

    void add(int i, int j, Complex y) {
        if (i >= 0 && j >= 0) {
            entries_.emplace_back(i, j, y);
        }
    }
    Result<void> build();

    /// Puts shares of the loads into the matrix.
    template <class Shares>
    void add_loads(Shares shares);
    void currents(Eigen::VectorXcd const& v, Eigen::VectorXcd& i) const;
    Result<ThreePhaseFlow> iterate(ThreePhaseOptions const& options);
    void results(Eigen::VectorXcd const& v, ThreePhaseFlow& out) const;

    Network const& n_;
    SwitchState const& state_;
    NetworkAround around_;
    std::vector<TwoPort const*> two_ports_;
    std::size_t adding_{0};         ///< the two-port that is being added
    OnePort const* added_{nullptr}; ///< the element at one bus that is being added
    std::optional<Error> refused_;  ///< what such an element asked for
    double hours_{0}, start_hour_of_day_{0};
    int nodes_{0};
    std::map<int, Complex> held_; ///< voltages of ideal sources, by node
    std::vector<double> phase_v_;
    std::vector<Eigen::Triplet<Complex>> entries_;
    std::vector<std::pair<int, Complex>> sources_;
    std::vector<std::pair<int, Complex>> linear_; ///< admittances of loads that are in the matrix, by node
    std::vector<DrawnPower> loads_;
    std::vector<std::pair<int, Complex>> converters_; ///< first node, kVA
    std::vector<Series> series_;
    std::vector<Limb> limbs_;
};

} // namespace gridspace::sim
