// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/fmu/call_guard.hpp"
#include "agents/fmu/fmu_table.hpp"
#include "agents/fmu/saved_state.hpp"
#include "common/time.hpp"

#include <map>
#include <memory>
#include <span>

namespace gridspace::agents {

/// An FMU from communication point to communication point. Knows the time of the run, and no bus.
class ModelRun {
  public:
    struct Settings {
        FmuConfig const& config;
        FmuTable const& table;
        fmi::ModelDescription const& description;
        TimeBase const& base;
        SimSpan period;
        std::filesystem::path state_file; ///< empty: the state is not kept
    };
    ModelRun(Settings settings, std::unique_ptr<fmi::Instance> instance, CallGuard& guard);

    /// Goes on with the state of an earlier process; false when there is none.
    [[nodiscard]] Result<bool> resume();
    /// The value that a variable has from the next communication point on.
    void input(std::size_t variable, fmi::Value value) { inputs_[variable] = std::move(value); }
    /// Steps to `point` with the inputs of the point before, then takes the new inputs and gives the outputs: a value
    /// for each variable of the table's `read`. The first point is its start. False when the FMU has ended itself
    /// before.
    [[nodiscard]] Result<bool> exchange(SimTime point);

    /// By variable; only those of `read` are new. Texts stay until the next exchange().
    [[nodiscard]] std::span<mapping::Value const> values() const { return values_; }

  private:
    [[nodiscard]] Result<void> start(SimTime point);
    [[nodiscard]] Result<void> take_inputs();
    [[nodiscard]] Result<bool> step_to(SimTime point);
    [[nodiscard]] Result<void> give_outputs(SimTime point);
    [[nodiscard]] fmi::Variable const& variable(std::size_t at) const { return settings_.description.variables[at]; }

    Settings settings_;
    CallGuard& guard_;
    std::map<std::size_t, fmi::Value> inputs_;
    std::vector<mapping::Value> values_;
    std::map<std::size_t, fmi::Value> outputs_; ///< what the texts of values_ point into
    std::optional<SimTime> at_;                 ///< the last communication point
    bool ended_{false};
    std::unique_ptr<fmi::Instance> instance_;
};

} // namespace gridspace::agents
