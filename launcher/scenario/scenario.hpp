// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"
#include "bus/node_config.hpp"
#include "common/config/fields.hpp"
#include "gateways/streams/stream.hpp"
#include "launcher/scenario/comtrade_settings.hpp"
#include "launcher/scenario/program.hpp"
#include "launcher/scenario/report_settings.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/security_settings.hpp"
#include "sim/app/sim_config.hpp"
#include "sim/events/event.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::sim {
struct Network;
}

namespace gridspace::launcher {

using config::Ref;

struct Host {
    Ref name;
    std::vector<Ref> links;
    std::vector<std::pair<Ref, std::string>>
        plugs; ///< by link: a real interface of this machine in the place of the cable
};

/// An Ethernet switch (a bridge) that hosts are plugged into.
struct Link {
    Ref name;
    std::string ipv4; ///< "10.10.0.0/24"; empty: no IP on it
    double delay_us{0};
};

struct Process {
    Ref name;
    Ref program;
    Ref host;
    Ref qos; ///< role: qos/<role>.xml
    std::string run_on{"native"};
    SshSettings ssh;
    std::optional<std::int64_t> cpu;
    std::string interface;
    Ref link;                 ///< on which it exchanges raw frames, where the host is plugged into several
    std::vector<Ref> prp;     ///< instead of `link`: networks A and B of a doubly attached node
    std::vector<Ref> capture; ///< links whose frames are recorded
    config::Node node;        ///< everything that was written about it, defaults included
    std::unique_ptr<ProcessSettings> settings;

    /// Somebody else's program: `exec`, or `program: {path: ...}`.
    [[nodiscard]] bool is_foreign() const {
        return program.name == "exec" || (settings != nullptr && !settings->command().empty());
    }
};

struct ClockSettings {
    bus::ClockMode mode{bus::ClockMode::lockstep};
    double speed{0}; ///< 0: max
    std::optional<Rational> tick_s;
    std::optional<std::int64_t> tick_samples; ///< of `auto` what it came to
    bool tick_samples_auto{false};
    bool shared_memory{true}; ///< lockstep: for clock and acknowledgements, where all members are on this machine
    double member_timeout_s{10}, start_timeout_s{30};
    bool start_at_utc_second{false};
    bool fifo{true};  ///< real time: SCHED_FIFO where it is permitted
    bool awake{true}; ///< real time, and lockstep at full speed: no processor goes to sleep, where that is permitted
};

struct RecordSettings {
    bool samples{true};
    std::string frames{"none"};
    std::vector<std::string> signals{"*"};
    std::optional<ComtradeSettings> comtrade;
};

/// A scenario as it was written, resolved (extends, defaults, --set) and read.
struct Scenario {
    std::filesystem::path file;
    std::string name, description;
    std::int64_t seed{0};
    sim::SimulationConfig simulation;
    ClockSettings clock;
    std::vector<Host> hosts;
    std::vector<Link> links;
    std::vector<Process> processes;
    std::vector<sim::Event> events;
    RecordSettings record;
    std::optional<SecuritySettings> security;
    std::vector<streams::Stream> streams;
    std::vector<attacker::AttackConfig> attacks;
    std::string allow_attacks_on; ///< --allow-attacks-on: an interface that is not a virtual cable
    config::Node expect;
    ReportSettings report;
    config::Node resolved;                       ///< the whole tree after merging
    std::shared_ptr<sim::Network const> network; ///< as it is simulated; none when the scenario names none

    [[nodiscard]] Process const* find_process(std::string_view process) const;
    [[nodiscard]] Process const* simulator() const; ///< the one gridspace-sim
    [[nodiscard]] Rational tick_s() const;
    [[nodiscard]] Rational quantum_s() const; ///< of which step and tick are whole multiples
};

/// Events that act on processes, in the order in which they happen.
[[nodiscard]] std::vector<sim::Event> process_events(Scenario const& scenario);

/// The keys of a scenario file, for its schema; `processes` without the keys of the programs.
void describe_scenario_keys(config::Fields& fields);

struct LoadOptions {
    config::Node const* over{nullptr};  ///< laid over the file first, as by a file that extends it
    std::vector<std::string> set{};     ///< --set a.b=c
    std::optional<double> speed{};      ///< --speed; 0: max
    std::optional<std::string> until{}; ///< --until 10s
    std::optional<std::string> seed{};  ///< --seed; read as the value of the file
    std::string allow_attacks_on{};     ///< --allow-attacks-on
    bool start_programs{true};          ///< programs of somebody else are asked what they are; false: refused
};

/// Reads and checks a scenario: syntax, keys, references, network and power flow, dataflow, expectations. Everything
/// that is wrong is in `diagnostics`; nothing is returned when there are errors.
[[nodiscard]] std::unique_ptr<Scenario> load_scenario(std::filesystem::path const& file, LoadOptions const& options,
                                                      config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
