// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"
#include "agents/attacker/wire_attack.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/goose_template.hpp"
#include "gateways/streams/stream.hpp"

#include <atomic>
#include <memory>
#include <optional>

namespace gridspace::attacker {

/// An attack on the messages of one GOOSE stream: forges as a second publisher, or alters and drops as a man in the
/// middle. The label of a message is its number since the start, and what the real publisher said of the attacked
/// Boolean (a dropped message: sent as said, the attack's kind tells). Pure; no allocation per message.
class GooseForger final : public WireAttack {
  public:
    [[nodiscard]] static Result<std::unique_ptr<GooseForger>> create(streams::Stream const& stream,
                                                                     AttackConfig const& config, std::uint64_t seed);

    void pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) override;
    [[nodiscard]] std::optional<std::int64_t> due() const override { return attack_.next_ns(); }
    void elapse(std::int64_t now_ns, Emit const& emit, Tell const& tell) override;

    void trigger(std::int64_t now_ns) override { attack_.trigger(now_ns); }
    void set_source(iec61850::Mac const& source) override { template_.set_source(source); }
    void set_utc_base(std::int64_t utc_base_ns) override { utc_base_ns_ = utc_base_ns; }
    [[nodiscard]] std::uint64_t forged() const override { return forged_.load(std::memory_order_relaxed); }

  private:
    GooseForger(streams::Stream const& stream, AttackConfig const& config, GooseAttack attack,
                iec61850::GooseTemplate frame, std::size_t leaf);
    [[nodiscard]] iec61850::Octets frame_of(GooseState const& state);
    void count() { forged_.store(attack_.forged() + attack_.dropped(), std::memory_order_relaxed); }
    void tell_one(bool sent, Tell const& tell);

    iec61850::GooseSubscriber heard_;
    GooseAttack attack_;
    iec61850::GooseTemplate template_;
    std::size_t leaf_;
    std::int64_t utc_base_ns_{0};
    bool spoof_;
    bool real_value_{false};
    iec61850::GooseFrame decoded_;
    std::int64_t labels_{0};
    std::atomic<std::uint64_t> forged_{0}; ///< forged and dropped
};

} // namespace gridspace::attacker
