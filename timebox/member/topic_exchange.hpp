// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/key.hpp"
#include "common/idl/native_layout.hpp"
#include "gateways/port/wire_clock.hpp"
#include "timebox/box.hpp"
#include "timebox/door/door.hpp"
#include "timebox/member/member_config.hpp"

#include <deque>
#include <memory>

namespace gridspace::timebox {

/// The topics of DDS between a program in its box and the bus of a run.
class TopicExchange {
  public:
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<TopicExchange>> open(bus::Node& node, MemberConfig const& config);

    [[nodiscard]] bool any() const { return !topics_.empty(); }
    [[nodiscard]] DoorOptions door();
    /// The samples of a tick, in an order that does not depend on the network.
    void bring(Box& box);
    /// The run is over: what the program still writes goes nowhere.
    void close() { over_ = true; }
    /// The simulator writes something that it reads, and wakes nobody.
    [[nodiscard]] bool hears_simulator() const { return hears_simulator_; }
    /// When the last sample that it has written takes effect: who reads it works then.
    [[nodiscard]] std::optional<SimTime> last_effect() const { return last_effect_; }
    struct Counters {
        std::uint64_t read{0}, written{0}, misfits{0};
    };
    [[nodiscard]] Counters counters() const { return counters_; }

  private:
    struct Topic {
        DoorTopic door;
        std::string type; ///< the codec's name points to it
        bus::Codec codec;
        std::optional<idl::NativeLayout> layout; ///< of a type that can be decoded
        std::optional<idl::KeyFinder> key;
        std::shared_ptr<bus::CdrReader> reader;
        std::unique_ptr<bus::CdrWriter> writer;
    };
    TopicExchange(bus::Node& node, MemberConfig const& config);
    [[nodiscard]] Result<void> add(BoxedTopic const& wanted, bool to_program);
    void take(std::int64_t now_ns, std::span<std::byte const> octets);
    /// False: it is not of its type.
    [[nodiscard]] bool find_key(Topic const& topic, std::span<std::byte const> cdr, bus::KeyHash& hash) const;
    /// Nothing takes effect earlier than that.
    void not_before(Topic const& topic, SimTime effect, std::vector<std::byte>& cdr) const;

    bus::Node& node_;
    MemberConfig const& config_;
    gateways::WireClock clock_;
    std::int64_t latency_ns_;
    std::deque<Topic> topics_;
    bool over_{false}, hears_simulator_{false};
    std::optional<SimTime> last_effect_;
    Counters counters_;
};

} // namespace gridspace::timebox
