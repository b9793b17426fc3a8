// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/label_publisher.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "agents/attacker/topic_attacks.hpp"
#include "agents/attacker/wire_attack.hpp"
#include "bus/node.hpp"
#include "common/spsc_ring.hpp"
#include "gateways/bump_in_the_wire/frame_hook.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
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
    std::int64_t now_ns{0}; ///< simulated: of what is being forged
    struct TimedLabel {
        Label label;
        std::int64_t time_ns{0};
    };
    SpscRing<TimedLabel> timed_labels{16'384};
    std::atomic<std::uint64_t> lost{0};
    Tell tell{[this](Label const& label) { lost += timed_labels.push({label, now_ns}) ? 0U : 1U; }};
    std::unique_ptr<LabelPublisher> labels;
    bool began{false}, ended{false};

    [[nodiscard]] bool between() const { return config->place == AttackConfig::Place::between; }
    [[nodiscard]] std::uint64_t forged() const {
        return values ? values->forged() : messages ? messages->forged() : topic->forged();
    }
};

/// The attacks in one direction of one cable, one behind the other.
class AttackHook final : public gateways::FrameHook {
  public:
    explicit AttackHook(bus::Node const& node) : node_{node} {}
    void add(Running& attack) { chain_.push_back(&attack); }
    [[nodiscard]] bool empty() const { return chain_.empty(); }

    void pass(gateways::PassingFrame const& frame, gateways::FrameOutput& out) override {
        hand_on(0, frame.octets, frame.time_ns, 0, out);
    }
    [[nodiscard]] std::optional<std::int64_t> due() const override {
        std::optional<std::int64_t> out;
        for (Running const* attack : chain_) {
            auto const next = attack->messages ? attack->messages->due() : std::nullopt;
            out = next && (!out || *next < *out) ? next : out;
        }
        return out;
    }
    void elapse(std::int64_t now_ns, gateways::FrameOutput& out) override {
        for (Running* attack : chain_) {
            if (attack->messages) {
                set_base(*attack);
                attack->now_ns = now_ns;
                attack->messages->elapse(now_ns, [&](auto octets) { out.send(octets); }, attack->tell);
            }
        }
    }

  private:
    void hand_on(std::size_t place, std::span<std::uint8_t const> octets, std::int64_t time_ns, std::int64_t delay_ns,
                 gateways::FrameOutput& out) {
        if (place == chain_.size()) {
            out.send(octets, delay_ns);
            return;
        }
        Running& attack = *chain_[place];
        attack.now_ns = time_ns;
        auto const hand_on_altered = [&](std::span<std::uint8_t const> altered) {
            std::int64_t const later = attack.messages ? attack.messages->delay_ns() : 0;
            hand_on(place + 1, altered, time_ns, delay_ns + later, out);
        };
        Emit const emit = std::cref(hand_on_altered); // what is captured would be allocated for each frame
        if (attack.values) {
            attack.values->pass(octets, time_ns, emit, attack.tell);
        } else {
            set_base(attack);
            attack.messages->pass(octets, time_ns, emit, attack.tell);
        }
    }
    void set_base(Running& attack) const {
        if (!node_.lockstep()) {
            attack.messages->set_utc_base(node_.start_unix_ns());
        }
    }

    bus::Node const& node_;
    std::vector<Running*> chain_;
};

} // namespace gridspace::attacker
