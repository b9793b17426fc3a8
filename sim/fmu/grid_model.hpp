// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/fmu/fmu_settings.hpp"
#include "sim/fmu/grid_inputs.hpp"
#include "sim/network/network.hpp"
#include "sim/runtime/simulation.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::sim {

/// An exported network as an importer runs it. Results are those of the same network in a scenario: an input
/// that has a new value is a set-point, or a command, at the beginning of the next step.
class GridModel {
  public:
    using Reference = std::uint32_t;
    static constexpr Reference kTime = 0;

    /// From the folder resources/ of the unpacked FMU. Nothing is solved yet.
    [[nodiscard]] static Result<std::unique_ptr<GridModel>> load(std::filesystem::path const& resources);

    [[nodiscard]] std::string const& token() const { return settings_.token; }
    [[nodiscard]] bool is_command(Reference reference) const; ///< true or false
    [[nodiscard]] bool is_mode(Reference reference) const;
    [[nodiscard]] bool is_number(Reference reference) const; ///< the time, a set-point or a signal

    /// Puts the network into its steady state at time 0, whatever the inputs are. From here on outputs can be read.
    [[nodiscard]] Result<void> start();
    /// As it was when it was loaded.
    void reset();

    /// Of an input; commands: 0 is false; modes: from 1. Takes effect with the next step. Fails out of its range.
    [[nodiscard]] Result<void> set(Reference reference, double value);
    /// Fails for an output before the start.
    [[nodiscard]] Result<double> get(Reference reference) const;

    /// From the present time `from_s` on, a whole number of steps of the engine. Afterwards outputs are those of its
    /// end, before inputs of that instant take effect.
    [[nodiscard]] Result<void> step(double from_s, double step_s);

    [[nodiscard]] double time_s() const;

  private:
    GridModel(FmuSettings settings, Network network);
    [[nodiscard]] Result<void> find_inputs();
    [[nodiscard]] Result<void> find_outputs();
    [[nodiscard]] GridInput const* input(Reference reference) const;

    FmuSettings settings_;
    Network network_;
    TimeBase base_;                    ///< its quantum is a step of the engine
    std::vector<GridInput> inputs_;    ///< by value reference, from 1
    std::vector<double> values_;       ///< of the inputs
    std::vector<double> in_effect_;    ///< what the engine knows of them
    std::vector<std::size_t> outputs_; ///< signals of the engine, by value reference behind the inputs
    std::unique_ptr<Simulation> run_;  ///< after start()
};

} // namespace gridspace::sim
