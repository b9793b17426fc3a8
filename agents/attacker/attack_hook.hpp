// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/running.hpp"
#include "bus/node.hpp"
#include "gateways/bump_in_the_wire/frame_hook.hpp"
#include "gateways/port/wire_clock.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

namespace gridspace::attacker {

/// The attacks in one direction of one cable, one behind the other.
class AttackHook final : public gateways::FrameHook {
  public:
    explicit AttackHook(bus::Node const& node) : clock_{node} {}
    void add(Running& attack) { chain_.push_back(&attack); }
    /// Of either direction: its condition looks at what passes here.
    void watch(Running& attack) { watching_.push_back(&attack); }

    void pass(gateways::PassingFrame const& frame, gateways::FrameOutput& out) override {
        for (Running* attack : watching_) {
            attack->look(frame.octets, frame.time_ns);
        }
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
    void set_base(Running& attack) const { attack.messages->set_utc_base(clock_.start_utc_ns()); }

    gateways::WireClock clock_;
    std::vector<Running*> chain_, watching_;
};

} // namespace gridspace::attacker
