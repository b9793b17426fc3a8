// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attacker_config.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "bus/node.hpp"

#include <memory>
#include <optional>

namespace gridspace::attacker {

/// An altered value, and the simulated time at which it is known to be one.
using TellAt = std::function<void(Label const&, std::int64_t time_ns)>;

/// An attack as a second publisher of a DDS topic.
class TopicAttack {
  public:
    virtual ~TopicAttack() = default;
    /// Takes what has come, and sends what is due up to and including `until_ns` (simulated time).
    virtual void work(std::int64_t until_ns, SimSpan latency, TellAt const& tell) = 0;
    [[nodiscard]] virtual std::optional<std::int64_t> due() const { return std::nullopt; }
    /// Lockstep: it must hear each sample in its tick, and those of the simulator wake nobody.
    [[nodiscard]] virtual bool works_in_every_tick() const { return false; }
    [[nodiscard]] virtual std::uint64_t forged() const = 0;
};

/// LineCurrents: the samples that come next, before the real ones. TripCommand: forged commands.
[[nodiscard]] Result<std::unique_ptr<TopicAttack>> make_topic_attack(bus::Node& node, AttackConfig const& config,
                                                                     AttackerSettings const& settings);

} // namespace gridspace::attacker
