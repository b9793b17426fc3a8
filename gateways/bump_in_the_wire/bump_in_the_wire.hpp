// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "bus/tick_grid.hpp"
#include "common/result.hpp"
#include "gateways/bump_in_the_wire/bump_config.hpp"
#include "gateways/bump_in_the_wire/frame_hook.hpp"

#include <memory>

namespace gridspace::gateways {

/// Stands in the cable between a host and a switch and hands every frame of SV and GOOSE of the chosen direction to a
/// hook (or lets it hear them while they pass); everything else passes untouched and at once. In lockstep it takes part
/// in the ledgers: what comes in is due at its simulated send time, and what goes on is entered with its own; in real
/// time its own thread does the work as frames come.
class BumpInTheWire {
  public:
    /// Hooks of the two directions; needed where the configuration takes a direction. They must outlive the bump in the
    /// wire.
    struct Hooks {
        FrameHook* from_host{nullptr};
        FrameHook* to_host{nullptr};
    };
    /// Opens both interfaces; frames pass from now on. Before Node::start; must not outlive the node. `speed`:
    /// simulated seconds per second in real time.
    [[nodiscard]] static Result<std::unique_ptr<BumpInTheWire>> open(bus::Node& node, BumpConfig const& config,
                                                                     double speed, Hooks hooks);
    ~BumpInTheWire();
    BumpInTheWire(BumpInTheWire const&) = delete;
    BumpInTheWire& operator=(BumpInTheWire const&) = delete;

    /// Lockstep: everything that belongs to the tick that ends at `end`. Real time: nothing.
    void work(SimTime end);
    /// Lockstep: the first later tick in which there is something to do even if no frame comes; for Node::done.
    [[nodiscard]] std::uint64_t next_tick(bus::TickGrid const& grid) const;

    struct Counters {
        std::uint64_t received{0}; ///< frames that the hook saw
        std::uint64_t sent{0};     ///< frames that went on
        std::uint64_t lost{0};     ///< not as the hook wanted: the delay line was full or the kernel did not take it
    };
    [[nodiscard]] Counters from_host() const;
    [[nodiscard]] Counters to_host() const;

  private:
    struct Way;
    struct Impl;
    explicit BumpInTheWire(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace gridspace::gateways
