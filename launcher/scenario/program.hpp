// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"
#include "common/rational.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

struct Scenario;
struct Process;
struct Readiness;

/// A topic that a process reads or writes.
struct TopicUse {
    std::string topic;
    std::string type;
    std::int64_t endpoints{1};   ///< how many readers or writers it has on the topic
    bool triggers{false};        ///< reading side: a sample makes the process work in the same tick
    bool optional{false};        ///< reading side: an input that may stay unused; writing side: nobody has to read it
    std::filesystem::path idl{}; ///< of a type that is not ours
};

/// Raw frames that a process sends or receives.
struct WireUse {
    std::string link;
    std::uint16_t ethertype{0};
    std::string stream;    ///< its name in the scenario; empty: every frame of the ethertype
    bool at_switch{false}; ///< receiving side: at the ports of the switch, not at the host's end of its cable
};

/// A process that sits in the cable between a host and a switch: frames of the directions that it takes go through its
/// hands, the others pass untouched.
struct BumpUse {
    config::Ref host, link;
    bool from_host{false}, to_host{false};
    std::vector<std::uint16_t> heard_to_host{}; ///< ethertypes that it also hears there, while they pass untouched
};

/// A signal that a process publishes.
struct SignalUse {
    std::string name;
    std::string unit;
    double rate_hz{0}; ///< 0: when something changes
};

/// What the launcher has to know about one process of a program: its settings, and what follows from them.
class ProcessSettings {
  public:
    virtual ~ProcessSettings() = default;

    /// Everything has been read: what it is may depend on the rest of the scenario. Before anything else is asked; of
    /// the simulator first.
    virtual void settle(Scenario const& /*scenario*/, Process const& /*process*/) {}
    /// Looks at the rest of the scenario: names that must exist, values that come from the network.
    virtual void check(Scenario const& /*scenario*/, Process const& /*process*/, config::Diagnostics& /*diagnostics*/) {
    }
    [[nodiscard]] virtual std::vector<TopicUse> writes(Scenario const&, Process const&) const { return {}; }
    [[nodiscard]] virtual std::vector<TopicUse> reads(Scenario const&, Process const&) const { return {}; }
    /// In lockstep a frame makes its receivers work in the same tick.
    [[nodiscard]] virtual std::vector<WireUse> sends(Scenario const&, Process const&) const { return {}; }
    [[nodiscard]] virtual std::vector<WireUse> receives(Scenario const&, Process const&) const { return {}; }
    /// Must not ask for what is sent or received through bumps in the wire.
    [[nodiscard]] virtual std::vector<BumpUse> bumps(Scenario const&, Process const&) const { return {}; }
    /// Hosts into whose networks it looks from its own; GRIDSPACE_NETWORKS says where they are.
    [[nodiscard]] virtual std::vector<std::string> networks(Scenario const&, Process const&) const { return {}; }
    [[nodiscard]] virtual std::vector<SignalUse> signals(Scenario const&, Process const&) const { return {}; }
    /// Takes part in the barrier in lockstep.
    [[nodiscard]] virtual bool is_member() const { return true; }
    /// Waits for others to be matched before it is ready, and others for it.
    [[nodiscard]] virtual bool is_expected() const { return true; }
    /// From input to effect.
    [[nodiscard]] virtual Rational latency_s(Process const&) const { return Rational{0}; }
    /// Lockstep: for input up to an instant, everything that it sends up to so long after that instant is sent. At most
    /// its latency; what a program sends by timers of its own counts too.
    [[nodiscard]] virtual Rational promises_s(Process const&) const { return Rational{0}; }
    /// Lockstep: what it sends in a tick is due after it, so nobody waits for it within the tick, and it may answer who
    /// answers it.
    [[nodiscard]] virtual bool sends_late(Scenario const&) const { return false; }
    /// Lockstep: its ticks may end later than the clock's, where its input is complete so far (`ahead_s`).
    [[nodiscard]] virtual bool works_ahead() const { return false; }
    /// `settings:` of the configuration file that the process is started with.
    [[nodiscard]] virtual config::Node settings(Scenario const& scenario, Process const& process) const = 0;
    /// The command with its arguments, for a program that is not ours; empty otherwise.
    [[nodiscard]] virtual std::vector<std::string> command() const { return {}; }
    /// Our program that runs somebody else's, which stands in its settings; empty: none.
    [[nodiscard]] virtual std::string_view carried_by() const { return {}; }
    /// Whether the command takes --config, --log-level and --status-fd, as our programs do.
    [[nodiscard]] virtual bool is_daemon() const { return command().empty(); }
    /// A virtual machine that stands for its host, whose interfaces are handed over to it.
    [[nodiscard]] virtual bool is_guest() const { return false; }
    /// When it is ready; nullptr: as soon as it is started, or as it says itself.
    [[nodiscard]] virtual Readiness const* readiness() const { return nullptr; }
    /// An address on which the process serves; the launcher opens the socket ("127.0.0.1:0").
    [[nodiscard]] virtual std::string listen() const { return {}; }
};

/// A program that a scenario can start.
struct Program {
    std::string_view name;
    std::string_view description;
    std::string_view default_role; ///< QoS role when the process names none
    std::unique_ptr<ProcessSettings> (*read)(config::Fields& fields);
    program::Declaration const* declaration{nullptr}; ///< of ours: names of settings in the place of their values
};

/// nullptr for a name that is not a program.
[[nodiscard]] Program const* find_program(std::string_view name);
[[nodiscard]] std::vector<std::string> program_names();

/// The keys of a process that are the launcher's, not the program's.
[[nodiscard]] bool is_common_key(std::string_view key);

/// The process's own keys as a settings tree.
[[nodiscard]] config::Node own_settings(Process const& process);

} // namespace gridspace::launcher
