// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "sim/gateway/gateway_config.hpp"
#include "sim/gateway/sampled_topic.hpp"
#include "sim/runtime/simulation.hpp"

#include <memory>
#include <vector>

struct TripCommand;

namespace gridspace::sim {

/// The simulator's DDS gateway of one line: sampled currents of its transformers out, trip commands for its breakers
/// in.
class LineGateway {
  public:
    [[nodiscard]] static Result<std::unique_ptr<LineGateway>> create(bus::Node& node, Engine& engine,
                                                                     Network const& network,
                                                                     LineGatewayConfig const& config,
                                                                     SamplingConfig const& sampling);
    ~LineGateway();

    /// Takes a sample if `t` is a sampling instant; a message is sent when it is full.
    void observe(SimTime t);
    /// The tick ends: what has been gathered is sent, so that nobody waits for a sample of a tick that is over.
    void flush();
    /// Real time, on the publishing thread: writes what was sent up to `until`.
    void drain(SimTime until);
    [[nodiscard]] std::uint64_t lost() const; ///< messages that the publishing thread was too slow for
    /// Passes trip commands on to the simulation, which now goes on from `now`.
    void take_commands(Simulation& simulation);

  private:
    LineGateway() = default;
    struct Trip {
        std::vector<std::string> breakers;
        std::vector<bool> follows; ///< by breaker: not latched
        bool last{false};          ///< the signal
        std::shared_ptr<bus::Reader<TripCommand>> commands;
    };
    [[nodiscard]] SimTime realtime_effect(std::int64_t time_ns, SimTime now) const;

    bus::Node* node_{nullptr};
    Engine* engine_{nullptr};
    SimSpan sample_span_;
    std::vector<std::unique_ptr<SampledTopic>> topics_;
    std::vector<Trip> trips_;
};

} // namespace gridspace::sim
