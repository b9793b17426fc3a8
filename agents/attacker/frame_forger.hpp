// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"
#include "agents/attacker/frame_attack.hpp"
#include "agents/attacker/stream_condition.hpp"
#include "agents/attacker/sv_target.hpp"
#include "agents/attacker/wire_attack.hpp"

#include <atomic>
#include <memory>
#include <vector>

namespace gridspace::attacker {

/// An attack on the frames of one stream of sampled values: their counters, times, number and synchronisation. Each
/// sample of a frame that it acts on has a label of channel 3 (idl/intrusion.idl says what its values are). Pure; no
/// allocation per frame.
class FrameForger final : public WireAttack {
  public:
    [[nodiscard]] static Result<std::unique_ptr<FrameForger>> create(streams::Stream const& stream,
                                                                     AttackConfig const& config, std::uint64_t seed);

    void pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) override;
    [[nodiscard]] std::int64_t delay_ns() const override { return delay_ns_; }
    [[nodiscard]] std::optional<std::int64_t> due() const override { return attack_.next_ns(); }
    void elapse(std::int64_t now_ns, Emit const& emit, Tell const& tell) override;
    void trigger(std::int64_t now_ns) override { attack_.trigger(now_ns); }
    void set_source(iec61850::Mac const& source) override { source_ = source; }
    [[nodiscard]] std::uint64_t forged() const override { return forged_.load(std::memory_order_relaxed); }

  private:
    FrameForger(streams::Stream const& stream, AttackConfig const& config, std::uint64_t seed);
    /// Writes a number of so many octets behind its tag in the ASDU; false when it is not there in that size.
    [[nodiscard]] bool rewrite(iec61850::Asdu const& asdu, std::uint8_t tag, std::size_t octets, std::uint64_t value);
    [[nodiscard]] double altered(iec61850::Asdu const& asdu);

    SvTarget target_;
    double rate_hz_;
    std::optional<StreamCondition> condition_; ///< on the target itself
    FrameAttack attack_;
    bool in_cable_, spoof_;
    std::optional<iec61850::Mac> source_;
    iec61850::SvFrame decoded_;
    std::vector<std::uint8_t> buffer_; ///< the frame that goes on; flood: the newest one
    std::vector<std::int64_t> newest_; ///< flood: the samples of that frame
    std::int64_t copies_{0};           ///< of it
    std::int64_t delay_ns_{0};
    std::atomic<std::uint64_t> forged_{0};
};

} // namespace gridspace::attacker
