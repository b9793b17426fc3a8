// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/anticipation.hpp"
#include "agents/attacker/attack_config.hpp"
#include "agents/attacker/sv_target.hpp"
#include "agents/attacker/wire_attack.hpp"

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace gridspace::attacker {

/// An attack on the values of one stream of sampled values. Pure: frames and times are given to it. No allocation per
/// frame.
class SvForger {
  public:
    [[nodiscard]] static Result<std::unique_ptr<SvForger>>
    create(streams::Stream const& stream, AttackConfig const& config, double frequency_hz, std::uint64_t seed);

    /// Man in the middle: `emit`s the frame, altered where the attack is due. Frames of others pass as they are.
    /// `time_ns`: simulated; it gives the second to which smpCnt belongs.
    void pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell);

    /// Second publisher: listens to a real frame, and `emit`s the one that is to come before the next real one.
    void hear(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell);
    /// What it waits for has come, on another stream.
    void trigger() {
        attack_.trigger();
        anticipation_.trigger();
    }
    /// The address that forged frames come from.
    void set_source(iec61850::Mac const& source) { template_.set_source(source); }

    [[nodiscard]] std::uint64_t forged() const {
        return forged_.load(std::memory_order_relaxed);
    } ///< frames; from any thread

  private:
    SvForger(streams::Stream const& stream, AttackConfig const& config, SampleAttack attack,
             iec61850::SvTemplate frame);
    [[nodiscard]] Abc read(iec61850::Octets sample) const;
    /// Writes one current; what a receiver reads of it.
    double write(std::size_t phase, double value_a, std::span<std::uint8_t> sample) const;
    void forge_next(Emit const& emit);

    SvTarget target_;
    std::array<std::size_t, 3> slots_{};
    std::array<double, 3> scales_{};
    double rate_hz_;
    Anticipation anticipation_;
    SampleAttack attack_;
    iec61850::SvTemplate template_;
    bool spoof_;
    iec61850::SvFrame decoded_;
    std::vector<std::uint8_t> buffer_, last_sample_;
    std::atomic<std::uint64_t> forged_{0};
};

/// Names of the three phase currents of a stream: its first three numbers, as their channels are counted.
[[nodiscard]] std::vector<std::string> phase_channels(streams::Stream const& stream);

} // namespace gridspace::attacker
