// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "sim/gateway/charging_orders.hpp"
#include "sim/gateway/outbox.hpp"
#include "sim/runtime/simulation.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

struct BusMeasurement;
struct ChargingDecision;

namespace gridspace::sim {

struct Network;

/// The simulator's DDS gateway of one bus: bus_measurements out, decisions for the EVs at the bus in.
class BusGateway {
  public:
    [[nodiscard]] static Result<std::unique_ptr<BusGateway>> create(bus::Node& node, Engine& engine,
                                                                    Network const& network, std::string const& bus);
    ~BusGateway();

    /// Publishes what is measured at the bus at `t`; in real time drain() does, on the publishing thread.
    void publish(SimTime t);
    void drain(SimTime until);
    [[nodiscard]] std::uint64_t lost() const;

    /// Passes what has arrived on to the simulation, which now goes on from `now` to `until`. A decision holds for its
    /// valid_for_s; then the charger stops.
    void take_commands(Simulation& simulation, SimTime until);
    /// Called when a decision cannot be obeyed and is ignored, with a sentence about it; not for every one of a row.
    void on_refusal(std::function<void(SimTime, std::string const&)> callback) { on_refusal_ = std::move(callback); }

  private:
    BusGateway() = default;
    /// A signal, and how it counts in a sum.
    struct Term {
        std::size_t signal{0};
        double sign{1};
    };
    /// What is consumed at the bus: a signal of the solver, or what its elements say.
    [[nodiscard]] static std::vector<Term> consumed(Engine& engine, Network const& network, std::string const& bus,
                                                    std::string_view quantity);
    [[nodiscard]] double sum(std::vector<Term> const& terms) const;
    struct EvPort {
        std::size_t soc{0}, current{0}, reference{0}; ///< signals
    };

    bus::Node* node_{nullptr};
    Engine* engine_{nullptr};
    std::unique_ptr<bus::Writer<BusMeasurement>> measurements_;
    std::shared_ptr<bus::Reader<ChargingDecision>> decisions_; ///< only where there are EVs
    std::unique_ptr<BusMeasurement> sample_;
    std::unique_ptr<Outbox<BusMeasurement>> outbox_; ///< real time
    std::size_t v_{0}, angle_{0}, frequency_{0};     ///< signals
    std::vector<Term> p_, q_;
    std::vector<EvPort> evs_;
    std::unique_ptr<ChargingOrders> orders_; ///< for the same EVs
    std::function<void(SimTime, std::string const&)> on_refusal_;
};

} // namespace gridspace::sim
