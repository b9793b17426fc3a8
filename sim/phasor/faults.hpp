// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/engine/action.hpp"
#include "sim/powerflow/branch.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::sim::phasor {

/// Short circuits in a phasor network: balanced ones, one per line at a time; or a single unbalanced one, which is what
/// its sequence networks make of it.
class Faults {
  public:
    /// Fails for unknown places, a second fault on a line, and anything besides an unbalanced fault.
    [[nodiscard]] Result<void> apply(Network const& network, ApplyFault const& fault);
    /// Fails when there is no such fault.
    [[nodiscard]] Result<void> clear(std::string const& name);
    /// Puts the faults into branches and shunts (by bus). `out`: elements that were disconnected.
    [[nodiscard]] Result<void> enter(Network const& network, SwitchState const& switches,
                                     std::set<std::string> const& out, std::vector<Branch>& branches,
                                     std::vector<Complex>& shunts) const;

  private:
    std::map<std::string, ApplyFault> active_, known_;
};

} // namespace gridspace::sim::phasor
