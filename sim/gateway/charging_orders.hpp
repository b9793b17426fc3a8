// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "sim/runtime/simulation.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {

/// The last decisions for the chargers of some EVs, and how long they hold: decisions in, commands to the simulation
/// out. A decision may come from any program: nothing of it reaches a solver unchecked.
class ChargingOrders {
  public:
    ChargingOrders(TimeBase base, std::vector<std::string> const& evs);

    [[nodiscard]] bool has(std::string_view ev) const;

    /// `current_a` from `effect` on, for `valid_for_s`; then the charger stops. One that cannot be obeyed changes
    /// nothing: then it returns what is wrong ("current_a is nan"), once until it obeys a decision for that EV again.
    /// Ignores EVs that are not its own.
    [[nodiscard]] std::optional<std::string> take(Simulation& simulation, SimTime effect, std::string_view ev,
                                                  double current_a, double valid_for_s);
    /// Stops the chargers whose decision ends by `until`.
    void expire(Simulation& simulation, SimTime until);

  private:
    struct Order {
        std::string ev;
        std::optional<SimTime> expires;
        bool refused{false}; ///< the last decision, and it was said
    };

    TimeBase base_;
    std::vector<Order> orders_;
};

} // namespace gridspace::sim
