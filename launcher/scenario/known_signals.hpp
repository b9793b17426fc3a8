// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"
#include "launcher/judge/moment.hpp"
#include "launcher/scenario/scenario.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// What expectations and figures of a scenario may refer to, and how a mistake is reported.
class KnownSignals {
  public:
    explicit KnownSignals(Scenario const& scenario);

    /// Whoever names a signal or an event, and where it is written.
    struct User {
        std::string name; ///< "expectation 'v_min'"
        config::SourceMark where;
        int width{0};
        bool lenient{false}; ///< what is not recorded is a warning
    };
    /// Signals (or patterns) that no process of the scenario has, or that the run does not record.
    void check(std::vector<std::string> const& patterns, User const& user, config::Diagnostics& diagnostics) const;
    /// Events of the timeline that do not exist. What processes report is known only after the run.
    void check(std::optional<Moment> const& moment, User const& user, config::Diagnostics& diagnostics) const;
    /// A pattern of streams, or of processes.
    void check_name(std::string const& pattern, User const& user, config::Diagnostics& diagnostics) const;

  private:
    std::vector<std::string> signals_, recorded_, events_, names_;
    std::string remedy_; ///< what makes the run record samples at all; empty when it does
};

} // namespace gridspace::launcher
