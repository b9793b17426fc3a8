// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attacker_config.hpp"
#include "agents/attacker/label_publisher.hpp"
#include "agents/attacker/stream_condition.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "agents/attacker/topic_attacks.hpp"
#include "agents/attacker/wire_attack.hpp"
#include "common/spsc_ring.hpp"

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace gridspace::attacker {

/// One attack in this process: its forger, whatever it is, and its labels on their way from the thread that forges.
struct Running {
    AttackConfig const* config{nullptr};
    std::unique_ptr<SvForger> values;
    std::unique_ptr<WireAttack> messages; ///< on messages, or on frames of sampled values
    std::unique_ptr<TopicAttack> topic;
    std::optional<StreamCondition> condition; ///< on another stream than the target
    std::int64_t now_ns{0};                   ///< simulated: of what is being forged
    struct TimedLabel {
        Label label;
        std::int64_t time_ns{0};
    };
    SpscRing<TimedLabel> timed_labels{16'384};
    std::atomic<std::uint64_t> lost{0};
    Tell tell{[this](Label const& label) { lost += timed_labels.push({label, now_ns}) ? 0U : 1U; }};
    std::unique_ptr<LabelPublisher> labels;
    std::optional<std::int64_t> first_ns; ///< simulated: of the first label that was taken
    bool began{false}, ended{false};

    [[nodiscard]] bool between() const { return config->place == AttackConfig::Place::between; }
    /// A frame passes the place where it sits, before anything becomes of it.
    void look(iec61850::Octets frame, std::int64_t time_ns) {
        if (!condition || !condition->met(frame, time_ns)) {
            return;
        }
        if (values) {
            values->trigger();
        } else {
            messages->trigger(time_ns);
        }
    }
    [[nodiscard]] std::uint64_t forged() const {
        return values ? values->forged() : messages ? messages->forged() : topic->forged();
    }
};

/// `config` must outlive it. Fails when the target is not there, or nothing of the kind can be done to it.
[[nodiscard]] Result<std::unique_ptr<Running>> make_attack(bus::Node& node, AttackConfig const& config,
                                                           AttackerSettings const& settings,
                                                           std::vector<streams::Stream> const& streams);

} // namespace gridspace::attacker
