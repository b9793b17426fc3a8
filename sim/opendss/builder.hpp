// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/line_constants/line_constants.hpp"
#include "sim/opendss/circuit.hpp"
#include "sim/opendss/dss_value.hpp"

#include <map>
#include <string>

namespace gridspace::opendss {

using sim::Conductor;
using sim::EarthModel;
using sim::LineConstants;

inline constexpr int kMaxPhases = 30;
inline constexpr double kSqrt3 = 1.7320508075688772935;

/// Where an element of two terminals is connected.
struct Terminals {
    explicit Terminals(config::SourceMark const& object) : where1{object}, where2{object} {}
    std::string bus1, bus2;
    config::SourceMark where1, where2;
    /// The properties bus1 and bus2.
    void add_to(Meaning& meaning);
};

/// The earth below a line.
struct Earth {
    double rho_ohm_m{100};
    EarthModel model{EarthModel::deri};
};

/// Of a load shape at an hour: multipliers, or, where it is `actual`, kW and kvar (0: it says nothing of them).
struct ShapeValue {
    double p{1}, q{1};
    bool actual{false};
};

/// Builds a circuit of the objects of a script: one function for each class, each in a file of its own.
class Builder {
  public:
    Builder(Script const& script, config::Diagnostics& diagnostics, std::optional<double> hour);
    std::optional<Circuit> build();

  private:
    void options();
    void source(Object const& object);
    void line(Object const& object);
    [[nodiscard]] Earth earth_below(Object const& line) const;
    std::optional<LineConstants> geometry(Value const& name, Earth const& earth);
    std::optional<LineConstants> spaced_wires(Value const& spacing, Value const& wires, Earth const& earth);
    std::optional<LineConstants> constants(std::vector<Conductor> const& conductors, int phases, Earth const& earth,
                                           config::SourceMark const& where);
    void transformer(Object const& object);
    void capacitor(Object const& object);
    void reactor(Object const& object);
    void load(Object const& object);
    void generator(Object const& object);
    void photovoltaic(Object const& object);
    void regulator(Object const& object);
    void capacitor_control(Object const& object);
    void check_connected();

    /// The nodes of a terminal: of "bus.1.2.0" those that are written, then 1, 2, … of the phases, then earth.
    std::vector<int> connect(Value const& bus, int phases, int conductors);
    std::vector<int> connect(std::string const& bus, config::SourceMark const& where, int phases, int conductors);
    void add(Object const& object, std::vector<int> nodes, int conductors, Eigen::MatrixXcd y,
             Eigen::VectorXcd injected = {});
    /// An element of two terminals of `phases` each, without bus2 to earth: its series admittance, and `shunt` at both
    /// ends. `emf`: its voltages, behind the admittance.
    void add_between(Object const& object, Terminals const& at, Eigen::MatrixXcd const& series,
                     Eigen::MatrixXcd const& shunt, Eigen::VectorXcd const& emf = {});
    /// The same branch between all phases, or from each to the second terminal (to earth without bus2).
    void add_branches(Object const& object, Terminals const& at, int phases, bool delta, Complex y);
    void consume(Object const& object, std::vector<int> const& nodes, int phases, bool delta, LoadLaw const& law);
    /// What a load shape says at the hour.
    ShapeValue shape(std::string const& name, config::SourceMark const& where);
    /// Lists what is not taken over and changes the result, for all that use it together.
    void leave_out_once(config::SourceMark const& where, std::string what);
    void error(config::SourceMark const& where, std::string message, std::string hint = {});

    Script const& script_;
    config::Diagnostics& diagnostics_;
    std::optional<double> hour_;
    Circuit circuit_;
    double omega_{0}, load_multiplier_{1};
    std::map<std::size_t, double> bank_kvar_; ///< of capacitors, all steps; by their place in the circuit's elements
    std::size_t admittances_{0};              ///< entries of all matrices
};

/// Admittance of an earthed star or a ring of equal branches: phases x phases.
[[nodiscard]] Eigen::MatrixXcd star(int phases, Complex y);
/// The matrix of a value of the positive and one of the zero sequence.
[[nodiscard]] Eigen::MatrixXcd from_sequences(int phases, Complex one, Complex zero);

} // namespace gridspace::opendss
