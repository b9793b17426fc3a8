// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/signal_publisher.hpp"
#include "sim/app/sim_config.hpp"
#include "sim/engine/engine.hpp"
#include "sim/gateway/outbox.hpp"

#include <memory>
#include <vector>

namespace gridspace::sim {

/// The engine's signals on the topics `signal_catalog` and `signals`.
class SignalOutput {
  public:
    [[nodiscard]] static Result<std::unique_ptr<SignalOutput>> create(bus::Node& node, Engine const& engine,
                                                                      SimConfig const& config);
    ~SignalOutput();

    void announce(SimTime now);
    /// At every step.
    void observe(SimTime t);
    void flush();
    /// Real time, on the publishing thread: publishes what was observed up to `until`.
    void drain(SimTime until);
    [[nodiscard]] std::uint64_t lost() const;

  private:
    SignalOutput() = default;
    struct Group {
        std::vector<std::size_t> signals;
        std::vector<double> row;
        std::unique_ptr<bus::SignalPublisher> publisher;
        std::unique_ptr<Outbox<std::vector<double>>> outbox; ///< real time
        void put(SimTime t);
        void read(Engine const& engine);
    };

    Engine const* engine_{nullptr};
    SimSpan period_;
    Group sampled_, switching_; ///< a group without signals has no publisher
    std::vector<double> last_switching_;
};

} // namespace gridspace::sim
