// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "sim/controls/controls.hpp"

#include <memory>

struct SetPoint;
struct ElementCommand;

namespace gridspace::sim {

/// The simulator's DDS gateway of `simulation.controls`: the topics set_points and commands, as far as there is
/// something to be steered or commanded.
class ControlGateway {
  public:
    [[nodiscard]] static Result<std::unique_ptr<ControlGateway>> create(bus::Node& node, Network const& network,
                                                                        std::vector<ControlConfig> const& configs,
                                                                        bool waveform, Control::Grid const& grid);
    ~ControlGateway();

    /// Passes what has arrived on to the simulation, which now goes on from `now` to `until`.
    void take_commands(Simulation& simulation, SimTime until);
    [[nodiscard]] Controls& controls() { return controls_; }

  private:
    ControlGateway(bus::Node& node, Controls controls, SimTime end);
    template <class T>
    struct Inbound;
    template <class T, class Pass>
    void pass_on(Inbound<T>& inbound, Simulation const& simulation, SimTime until, Pass const& pass);

    bus::Node& node_;
    Controls controls_;
    SimTime end_; ///< of the run
    std::unique_ptr<Inbound<SetPoint>> set_points_;
    std::unique_ptr<Inbound<ElementCommand>> commands_;
};

} // namespace gridspace::sim
