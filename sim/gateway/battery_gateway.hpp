// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "sim/engine/engine.hpp"
#include "sim/gateway/outbox.hpp"

#include <memory>
#include <string>

struct BatteryMeasurement;

namespace gridspace::sim {

/// The simulator's DDS gateway of one battery: battery_measurements out. Its set-points come by simulation.controls.
class BatteryGateway {
  public:
    [[nodiscard]] static Result<std::unique_ptr<BatteryGateway>> create(bus::Node& node, Engine const& engine,
                                                                        std::string const& battery);
    ~BatteryGateway();

    /// Publishes what is measured at `t`; in real time drain() does, on the publishing thread.
    void publish(SimTime t);
    void drain(SimTime until);
    [[nodiscard]] std::uint64_t lost() const;

  private:
    BatteryGateway(bus::Node& node, Engine const& engine);

    bus::Node& node_;
    Engine const& engine_;
    std::unique_ptr<bus::Writer<BatteryMeasurement>> measurements_;
    std::unique_ptr<BatteryMeasurement> sample_;
    std::unique_ptr<Outbox<BatteryMeasurement>> outbox_; ///< real time
    std::size_t soc_{0}, p_{0}, q_{0};                   ///< signals
};

} // namespace gridspace::sim
