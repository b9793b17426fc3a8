// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/matrix3.hpp"
#include "sim/circuit/norton.hpp"
#include "sim/circuit/phase_matrix.hpp"
#include "sim/circuit/pole_sum.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

/// A three-phase circuit in SI units: what the waveform solver simulates. Plain data; nodes come in triples (phases a,
/// b, c), named by the index of their first node. The first triple is earth.
namespace gridspace::sim::emt {

constexpr int kEarth = 0;

/// Coupled series resistance and inductance between two triples.
struct RlBranch {
    int from{kEarth}, to{kEarth};
    PhaseMatrix r, l;
};

struct CapacitorBranch {
    int from{kEarth}, to{kEarth};
    PhaseMatrix c;
};

/// Phases that are coupled unequally: v = R i + L di/dt, or i = C dv/dt. A line that is not transposed, a load by
/// phase.
struct CoupledBranch {
    enum class Kind { inductive, capacitive } kind{Kind::inductive};
    int from{kEarth}, to{kEarth};
    Matrix3 r{}, l{}; ///< inductive
    Matrix3 c{};      ///< capacitive
};

/// One resistance and inductance driven by a weighted sum of node voltages: v = sum w_k v_k = r i + l di/dt, and w_k i
/// flows out of node k. A transformer limb is one: its weights hold turns ratio and connection.
struct Winding {
    std::array<int, 4> nodes{}; ///< single nodes
    std::array<double, 4> weights{};
    double r{0}, l{0};
};

/// Inductance of an iron core with two slopes: l up to the flux linkage `knee`, l_air beyond; weights as for a winding.
struct SaturableCore {
    std::array<int, 4> nodes{};
    std::array<double, 4> weights{};
    double l{0}, l_air{0}, knee{0};
};

/// Lossless travel with the resistance lumped in quarters at the ends and a half in the middle, per mode
/// [Dommel, IEEE Trans. PAS-88, 1969].
struct BergeronLine {
    int from{kEarth}, to{kEarth};
    double z1{0}, z0{0};     ///< surge impedances, ohm
    double tau1{0}, tau0{0}; ///< travel times, s
    double r1{0}, r0{0};     ///< total resistances, ohm
    std::string name;
};

/// Frequency-dependent and transposed: each mode has a characteristic impedance and a propagation exp(-s tau) times a
/// rational function [J. Marti, IEEE Trans. PAS-101(1), 1982].
struct MartiLine {
    struct Mode {
        PoleSum impedance;   ///< ohm
        PoleSum propagation; ///< without the travel time
        double tau_s{0};
    };
    int from{kEarth}, to{kEarth};
    Mode positive, zero;
    std::string name;
};

/// Resistances from some phases of a triple to a common point, which may be earth. Each phase ends at its own current
/// zero.
struct FaultBranch {
    int node{kEarth};
    double r_ohm{0};
    std::array<bool, 3> phases{};
    bool earthed{true};
    std::string name;
};

/// A current through a switch is a sum of element currents.
struct CurrentTerm {
    enum class Kind {
        rl,
        capacitor,
        coupled,
        winding,
        core,
        bergeron_from,
        bergeron_to,
        marti_from,
        marti_to,
        fault,
        norton,
        injection
    } kind{Kind::rl};
    int index{0};
    double sign{1};
    int turn{0}; ///< windings and cores: the limb of phase (k + turn) % 3
};

/// Three poles between two triples; ideal: closed is one node, open is nothing.
struct Switch {
    int outer{kEarth}, inner{kEarth};
    std::array<bool, 3> closed{true, true, true};
    std::vector<CurrentTerm> terms; ///< whose sum flows from outer to inner
    std::string name;
};

/// Contacts part `after_s` from now. Each pole interrupts when its current falls to `chop_a` or passes through zero;
/// `at_once`: all do when they part.
struct Opening {
    double after_s{0}, chop_a{0};
    bool at_once{false};
    std::array<bool, 3> poles{true, true, true}; ///< that part
};

/// Ideal voltage source to earth: v_k = amplitude cos(phase - k 120 deg), with harmonics.
struct VoltageSource {
    int node{kEarth};
    double amplitude_v{0}, angle_rad{0}, frequency_hz{60};
    struct Harmonic {
        int order{1};
        double amplitude{0}, angle_rad{0}; ///< of the fundamental's amplitude
    };
    std::vector<Harmonic> harmonics;
    std::string name;
};

/// An element with states of its own.
struct NortonPort {
    int node{kEarth};
    std::shared_ptr<NortonElement> element;
};

/// Currents into a triple that somebody computes from what it measured in the step before.
struct Injection {
    int node{kEarth};
};

struct Circuit {
    double frequency_hz{60};
    double peak_v{0}; ///< of the highest nominal voltage, phase to earth: voltages far beyond are divergence
    std::vector<std::string> triples{"earth"}; ///< names for messages
    std::vector<RlBranch> rl;
    std::vector<CapacitorBranch> capacitors;
    std::vector<CoupledBranch> coupled;
    std::vector<Winding> windings;
    std::vector<SaturableCore> cores;
    std::vector<BergeronLine> bergeron;
    std::vector<MartiLine> marti;
    std::vector<FaultBranch> faults;
    std::vector<Switch> switches;
    std::vector<VoltageSource> sources;
    std::vector<NortonPort> norton;
    std::vector<Injection> injections;

    /// A new triple; returns its first node.
    int add_triple(std::string name) {
        triples.push_back(std::move(name));
        return static_cast<int>(triples.size() - 1) * 3;
    }
    /// New elements; their indices.
    int add_rl(int from, int to, PhaseMatrix const& r, PhaseMatrix const& l) {
        rl.push_back({from, to, r, l});
        return static_cast<int>(rl.size()) - 1;
    }
    int add_capacitor(int from, int to, PhaseMatrix const& c) {
        capacitors.push_back({from, to, c});
        return static_cast<int>(capacitors.size()) - 1;
    }
    /// An element's current is part of what flows through a switch, from outer to inner.
    void flows(int switch_index, CurrentTerm::Kind kind, std::size_t index, double sign) {
        switches[static_cast<std::size_t>(switch_index)].terms.push_back({kind, static_cast<int>(index), sign});
    }
    [[nodiscard]] int nodes() const { return static_cast<int>(triples.size()) * 3; }
    [[nodiscard]] std::string node_name(int node) const {
        return triples[static_cast<std::size_t>(node / 3)] + " phase " + "abc"[node % 3];
    }
};

/// What a two-port is in a circuit: a triple behind the poles of each end, and what is between them.
struct TwoPortParts {
    struct Section {
        enum class Kind { rl, coupled, wave, marti } kind{Kind::rl};
        int index{0};            ///< of the branch or travelling-wave line
        double start{0}, end{1}; ///< shares of the length
    };
    std::vector<Section> sections; ///< along a line; faults cut them. Empty: no fault can lie inside
    int from_node{0}, to_node{0};  ///< behind the poles, which breakers are
    int from_switch{0}, to_switch{0};
    int windings{0}; ///< the first of three that hold a transformer's ratio
};

} // namespace gridspace::sim::emt
