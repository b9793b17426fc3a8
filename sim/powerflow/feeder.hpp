// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/powerflow/three_phase.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <array>
#include <map>

namespace gridspace::sim {

/// The inside of the three-phase power flow. feeder.cpp makes the admittance matrix of the network, three_phase.cpp
/// iterates.
class Feeder : private PowerFlowFace {
  public:
    Feeder(Network const& n, SwitchState const& state);
    Result<ThreePhaseFlow> solve(ThreePhaseOptions const& options);

  private:
    using Matrix3 = Eigen::Matrix3cd;
    /// Three coils: their ends, and the volts of one at nominal voltage.
    struct Coils {
        std::array<std::pair<int, int>, 3> ends;
        double rated_v{0};
    };
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
        std::size_t index; ///< of the transformer
        Complex y;
        std::array<int, 4> nodes;
        std::array<double, 4> weights;
    };
    struct LineParts {
        std::size_t index;
        Matrix3 y, shunt;
        int from, to;
    };

    void inject(Ref const& bus, Complex kva) override { converters_.emplace_back(node_of(bus), kva); }
    void admit(Ref const& bus, Complex kva) override;
    void draw(Ref const& bus, VoltageDependent const& load, double scale) override {
        loads_.push_back({node_of(bus), phase_v_[bus_of(bus)], &load, scale});
    }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return n_.buses[bus_of(bus)].voltage_v; }
    [[nodiscard]] double scale(Ref const& profile) const override;

    std::size_t bus_of(Ref const& bus) const { return index_of(n_.buses, bus.name); }
    int node_of(Ref const& bus) const { return static_cast<int>(3 * bus_of(bus)); }
    void add(int i, int j, Complex y) {
        if (i >= 0 && j >= 0) {
            entries_.emplace_back(i, j, y);
        }
    }
    Result<void> build();
    void line(std::size_t index);
    Coils coils(Ref const& bus, Winding connection, bool forward);
    Result<void> transformer(std::size_t index);
    void limb(Limb const& l);
    Result<void> hold(std::string const& name, Ref const& bus, double pu, double angle_deg, Complex z1, Complex z0);
    Result<void> sources();

    /// Puts shares of the loads into the matrix.
    template <class Shares>
    void add_loads(Shares shares);
    void currents(Eigen::VectorXcd const& v, Eigen::VectorXcd& i) const;
    Result<ThreePhaseFlow> iterate(ThreePhaseOptions const& options);
    void results(Eigen::VectorXcd const& v, ThreePhaseFlow& out) const;

    Network const& n_;
    SwitchState const& state_;
    double omega_;
    double hours_{0}, start_hour_of_day_{0};
    int nodes_{0};
    std::map<int, Complex> held_; ///< voltages of ideal sources, by node
    std::vector<double> phase_v_;
    std::vector<Eigen::Triplet<Complex>> entries_;
    std::vector<std::pair<int, Complex>> sources_;
    std::vector<std::pair<int, Complex>> linear_; ///< admittances of loads that are in the matrix, by node
    std::vector<DrawnPower> loads_;
    std::vector<std::pair<int, Complex>> converters_; ///< first node, kVA
    std::vector<LineParts> lines_;
    std::vector<Limb> limbs_;
};

} // namespace gridspace::sim
