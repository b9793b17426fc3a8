// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/engine/action.hpp"
#include "sim/powerflow/two_port.hpp"

#include <map>
#include <string>
#include <vector>

namespace gridspace::sim::phasor {

/// Balanced short circuits in a phasor network. One fault per line at a time.
class Faults {
  public:
    /// Fails for unbalanced faults, unknown places and a second fault on a line.
    [[nodiscard]] Result<void> apply(Network const& network, ApplyFault const& fault);
    /// Fails when there is no such fault.
    [[nodiscard]] Result<void> clear(std::string const& name);
    /// Puts the faults into branches and shunts (by bus).
    void enter(Network const& network, SwitchState const& switches, std::vector<TwoPort>& branches,
               std::vector<Complex>& shunts) const;

  private:
    std::map<std::string, ApplyFault> active_, known_;
};

} // namespace gridspace::sim::phasor
