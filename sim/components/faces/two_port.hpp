// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/circuit.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

enum class LineEnd { from, to };

/// Which ends of a two-port are connected to their buses.
struct Ends {
    bool from{true}, to{true};
};

/// i_from = ff v_from + ft v_to, i_to = tf v_from + tt v_to; p.u. on the network's base.
struct Admittances {
    Complex ff, ft, tf, tt;
};
/// The same where some ends are open: what is seen from the others.
[[nodiscard]] Admittances seen_from(Admittances y, Ends closed);

/// A pi of something that has a length, in which a fault can lie.
struct PiSection {
    Complex series_ohm, half_s; ///< all of it; the shunt of one end
};

/// How the zero sequence finds its way to earth through a two-port.
struct EarthPaths {
    bool joins{false}, from{false}, to{false};
};

/// Three phases of the power flow by phase: ohm and siemens, by row.
using PhaseBlock = emt::Matrix3Of<Complex>;

/// What a two-port can be in the power flow by phase.
class PhaseNetworkFace {
  public:
    virtual ~PhaseNetworkFace() = default;
    /// Coupled phases between the two buses, and a shunt at each end.
    virtual void series(PhaseBlock const& z_ohm, PhaseBlock const& shunt_s) = 0;
    /// The current y (weights . voltages of the nodes) flows, times its weight, out of each node; -1: earth.
    virtual void limb(Complex y, std::array<int, 4> const& nodes, std::array<double, 4> const& weights) = 0;
    /// The first of the three nodes of a bus, and a new node.
    [[nodiscard]] virtual int node(Ref const& bus) const = 0;
    [[nodiscard]] virtual int add_node() = 0;
};

/// An element between two buses: a line, a transformer. Solvers know these faces and no kinds.
struct TwoPort : Element {
    Ref from, to;

    [[nodiscard]] virtual bool unbalanced(Surroundings const& /*around*/) const { return false; }
    /// Positive sequence: power flow and phasors.
    [[nodiscard]] virtual Admittances admittances(Surroundings const& around, Ends closed) const = 0;
    /// Negative and zero sequence of a fault; both ends closed. Not asked where pi() says it.
    [[nodiscard]] virtual Admittances sequence(Sequence /*sequence*/, Surroundings const& /*around*/) const {
        return {};
    }
    struct Pi {
        PiSection positive, zero;
    };
    [[nodiscard]] virtual std::optional<Pi> pi(Surroundings const& /*around*/) const { return {}; }
    [[nodiscard]] virtual EarthPaths earth_paths(Surroundings const& around, Ends closed) const = 0;
    /// Why a fault inside, at a place from `from`, cannot be simulated in waveforms, and what to do instead.
    [[nodiscard]] virtual std::optional<Refusal> refuses_fault(double /*percent*/) const { return {}; }
    virtual Result<void> phases(PhaseNetworkFace& face, Surroundings const& around) const = 0;
    /// Puts its parts between the ends into a circuit; its currents count into the element at each end.
    virtual Result<void> circuit(emt::Circuit& circuit, emt::TwoPortParts& parts, Surroundings const& around) const = 0;
    /// Changes a quantity in its data and in the circuit; false when it cannot have this value.
    virtual bool set_in_circuit(emt::Circuit& /*circuit*/, emt::TwoPortParts const& /*parts*/,
                                std::string_view /*quantity*/, double /*value*/) {
        return false;
    }
};

} // namespace gridspace::sim
