// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/foreign_permission.hpp"
#include "agents/relay/relay_program.hpp"
#include "bus/node.hpp"

#include <intrusion.h>

#include <deque>
#include <memory>
#include <string>

namespace gridspace::relay {

/// `foreign_detector:` of a relay: somebody else's verdicts from DDS, and the permission that follows from them.
class ForeignDetector {
  public:
    [[nodiscard]] static Result<std::unique_ptr<ForeignDetector>> create(bus::Node& node, RelayConfig const& config,
                                                                         double rate_hz);

    /// At each pair of samples, `index` counted from simulated time 0. Verdicts count from the instant on at which they
    /// were said.
    bool step(std::int64_t index, bool picked_up, SimTime now);
    [[nodiscard]] ForeignPermission const& permission() const { return permission_; }
    /// Who spoke last; empty: nobody yet.
    [[nodiscard]] std::string const& detector() const { return detector_; }

  private:
    ForeignDetector(RelayConfig const& config, ForeignPermissionParams const& params);
    void take(IdsVerdict const& verdict);

    std::array<std::string, 2> streams_;
    double rate_hz_{0};
    ForeignPermission permission_;
    std::shared_ptr<bus::Reader<IdsVerdict>> reader_;
    std::deque<bus::Received<IdsVerdict>> waiting_; ///< for their time
    std::string detector_;
};

} // namespace gridspace::relay
