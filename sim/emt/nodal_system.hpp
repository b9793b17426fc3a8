// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/emt/marti.hpp"
#include "sim/emt/shares.hpp"
#include "sim/emt/topology.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace gridspace::sim::emt {

/// What the elements' companion models need for a step of length h. Conductances are the same for one trapezoidal step
/// of h and for backward Euler steps of h/2: that is what makes critical damping adjustment cheap [Marti and Lin, IEEE
/// Trans. Power Syst. 4(2), 1989].
struct StepCoefficients {
    double h{0};
    std::vector<PhaseMatrix> rl_g, rl_trapezoid, rl_euler; ///< i' = g v' + (g v + trapezoid i), or + euler i
    std::vector<unsigned char> rl_stores;                  ///< has an inductance: a resistance alone has no history
    std::vector<PhaseMatrix> capacitor_g;
    /// i' = g v' + history; history = v_past v + i_past i, one pair for each rule.
    struct Coupled {
        Matrix3 g{}, v_trapezoid{}, i_trapezoid{}, v_euler{}, i_euler{};
    };
    std::vector<Coupled> coupled;
    std::vector<double> winding_g, winding_trapezoid, winding_euler;
    std::vector<MartiStep> marti;
    Admittances<double> admittances(Circuit const& circuit, SwitchBits const& bits) const;
};
void fill_coefficients(Circuit const& circuit, double h, StepCoefficients& out);

/// The nodal matrix of one switch state and one step length, ready to be solved.
struct NodalSystem {
    SwitchBits bits;
    double h{0};
    Topology topology;
    std::vector<int> anchored; ///< unknowns of parts without connection to earth
    bool dense{false};
    std::vector<double> inverse; ///< column-major
    Ldlt<double> factors;
    Shares shares; ///< by the division of its factors
    std::uint64_t last_used{0};
    /// What a system that differs little from another adds to its solution (nodal_update.cpp).
    struct Update {
        static constexpr std::size_t kMaxRank = 6;
        std::shared_ptr<NodalSystem const> base;
        std::size_t rank{0};
        std::vector<std::vector<std::pair<int, double>>> columns; ///< of U: slots and weights
        std::vector<double> w;                                    ///< A^-1 U, column-major
        std::array<std::array<double, kMaxRank>, kMaxRank> c{};
        /// x -= W C seen
        void subtract(std::array<double, kMaxRank> const& seen, double* x) const;
    };
    std::optional<Update> update;

    /// x := A^-1 b over the unknowns. Allocates nothing.
    void solve(double const* b, double* x) const;
    /// x += A^-1 e_slot value, for a dense system only.
    void add_column(int slot, double value, double* x) const;
    /// Several solve for it at the same time: factors_in_parts() by their down(), rest() and up(), then finish_parts().
    [[nodiscard]] bool divided() const { return shares.parts.size() > 1; }
    [[nodiscard]] Ldlt<double> const& factors_in_parts() const { return update ? update->base->factors : factors; }
    void finish_parts(double* x) const;
};
/// `parts`: that are to be solved for at the same time, where that is worth while.
[[nodiscard]] Result<std::shared_ptr<NodalSystem>> make_system(Circuit const& circuit, SwitchBits const& bits,
                                                               StepCoefficients const& coefficients, int parts = 1);

/// The system of `bits` by a low-rank change of another of the same step; nothing when they differ in poles, by more
/// than a few fault phases and cores, or so that a part loses its connection to earth.
[[nodiscard]] std::shared_ptr<NodalSystem>
update_system(Circuit const& circuit, std::shared_ptr<NodalSystem> const& base, SwitchBits const& bits);

} // namespace gridspace::sim::emt
