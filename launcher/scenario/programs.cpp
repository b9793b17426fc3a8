// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attacker_declaration.hpp"
#include "agents/ev/ev_config.hpp"
#include "agents/fmu/fmu_declaration.hpp"
#include "agents/mcca/mcca_config.hpp"
#include "agents/relay/relay_declaration.hpp"
#include "bus/topics.hpp"
#include "common/text.hpp"
#include "gateways/breaker/breaker_declaration.hpp"
#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/gateway/gateway_declaration.hpp"
#include "gateways/link/link_declaration.hpp"
#include "gateways/mu/mu_declaration.hpp"
#include "launcher/judge/consequences.hpp"
#include "launcher/scenario/capture_points.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/exec_program.hpp"
#include "launcher/scenario/monitor_program.hpp"
#include "launcher/scenario/own_topics.hpp"
#include "launcher/scenario/program.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "monitor/app/access_config.hpp"
#include "recorder/app/recorder_config.hpp"
#include "sim/app/sim_declaration.hpp"
#include "sim/controls/control_config.hpp"
#include "sim/gateway/gateway_config.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <set>
#include <span>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

constexpr std::array<std::string_view, 12> kCommonKeys{"program", "host", "qos",       "run_on",  "ssh",   "cpu",
                                                       "link",    "prp",  "interface", "capture", "label", "comment"};

/// A name must be among `names`, or it is an error with the nearest spelling.
bool check_name(Ref const& ref, std::vector<std::string> const& names, std::string const& what,
                Diagnostics& diagnostics) {
    if (std::find(names.begin(), names.end(), ref.name) != names.end()) {
        return true;
    }
    diagnostics.error(ref.where, fmt::format("{} '{}', which does not exist", what, ref.name),
                      spelling_hint(ref.name, names), static_cast<int>(ref.name.size()));
    return false;
}

class SimSettings final : public DeclaredSettings {
  public:
    static std::unique_ptr<ProcessSettings> read(Fields&) { return std::make_unique<SimSettings>(); }
    SimSettings() : DeclaredSettings{sim::sim_declaration()} {}
    void settle(Scenario const& s, Process const&) override {
        declare(sim::declaration(s.simulation, s.network.get()));
    }

    [[nodiscard]] bool is_expected() const override { return true; }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const& s, Process const& process) const override {
        std::vector<TopicUse> out = DeclaredSettings::reads(s, process);
        for (TopicUse& use : out) { // where nobody decides, EVs wait, or are steered by set-points
            use.optional = use.optional || (use.type == "ChargingDecision" && !somebody_decides(s));
        }
        return out;
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const&) const override { return simulator_settings(s); }

    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_signal_groups(s, process, diagnostics);
        sim::GatewaysConfig const all = sim::read_gateways(s.simulation.gateways, diagnostics);
        if (s.network) {
            check_gateways(all, *s.network, diagnostics);
        }
        (void)sim::read_sampling(s.simulation.sampling, diagnostics);
        check_steering(s, diagnostics);
    }

  private:
    /// "bus.*: 26, ev.*: 594".
    static std::string counts(std::map<std::string, std::size_t> const& of_kind) {
        std::vector<std::string> parts;
        for (auto const& [kind, count] : of_kind) {
            parts.push_back(fmt::format("{}: {}", kind, count));
        }
        return join(parts, ", ");
    }
    /// What it publishes together must fit into one sample of `signals` (sim/app/signal_output.cpp).
    void check_signal_groups(Scenario const& s, Process const& process, Diagnostics& diagnostics) const {
        std::size_t sampled = 0, switching = 0;
        std::vector<std::string> names;
        std::map<std::string, std::size_t> of_kind; // "bus.*": how many
        for (SignalUse const& signal : signals(s, process)) {
            bool const wanted = std::any_of(s.record.signals.begin(), s.record.signals.end(),
                                            [&](std::string const& p) { return matches_glob(p, signal.name); });
            (signal.rate_hz == 0 ? switching : sampled) += wanted ? 1 : 0;
            ++of_kind[signal.name.substr(0, signal.name.find('.')) + ".*"];
            names.push_back(signal.name);
        }
        if (sampled + switching == 0 && !s.record.signals.empty() && !names.empty()) {
            std::string const& first = s.record.signals.front();
            diagnostics.warning(
                process.name.where,
                fmt::format("none of its signals is one of record.signals ({})", join(s.record.signals, ", ")),
                did_you_mean(first, names, "`gridspace signals SCENARIO` lists them"));
        }
        for (auto const& [group, count] : {std::pair{"electrical", sampled}, {"switching", switching}}) {
            if (count > bus::kMaxSignals) {
                diagnostics.error(process.name.where,
                                  fmt::format("{} signals in group '{}', and {} fit", count, group, bus::kMaxSignals),
                                  fmt::format("choose some with record.signals, for example [{}]; there are {}",
                                              of_kind.begin()->first, counts(of_kind)));
            }
        }
    }
    /// Who may steer must be there and say so; nothing is steered by two.
    void check_steering(Scenario const& s, Diagnostics& diagnostics) const {
        std::vector<sim::ControlConfig> const all = sim::read_controls(s.simulation.controls, diagnostics);
        if (s.network) {
            check_controls(all, *s.network, s.simulation.solver == sim::SolverKind::emt, diagnostics);
        }
        std::vector<std::string> names;
        for (Process const& one : s.processes) {
            names.push_back(one.name.name);
        }
        Diagnostics said; // by check()
        bool const decided = sim::read_gateways(s.simulation.gateways, said).per_bus && somebody_decides(s);
        for (sim::ControlConfig const& control : all) {
            if (decided && control.kind->section == "evs" && control.quantity == "current_a") {
                diagnostics.error(
                    control.path.where,
                    fmt::format("control '{}': EVs are steered by the topic 'decisions' as well", control.path.name),
                    "`gateways: per_bus` reads it; one of the two", static_cast<int>(control.path.name.size()));
            }
            std::string const topic = control.quantity.empty() ? "commands" : "set_points";
            for (Ref const& from : control.from) {
                if (!check_name(from, names, fmt::format("control '{}' is for the process", control.path.name),
                                diagnostics)) {
                    continue;
                }
                Process const& who = *s.find_process(from.name);
                std::vector<TopicUse> const writes =
                    who.settings == nullptr ? std::vector<TopicUse>{} : who.settings->writes(s, who);
                if (who.settings != nullptr &&
                    std::none_of(writes.begin(), writes.end(), [&](auto const& use) { return use.topic == topic; })) {
                    diagnostics.error(from.where,
                                      fmt::format("control '{}': process '{}' does not write the topic '{}'",
                                                  control.path.name, from.name, topic),
                                      "what it writes is in its `writes:`, or the program says it itself",
                                      static_cast<int>(from.name.size()));
                }
            }
        }
    }
    static bool somebody_decides(Scenario const& s) {
        return std::any_of(s.processes.begin(), s.processes.end(), [&](Process const& who) {
            std::vector<TopicUse> const writes =
                who.settings == nullptr ? std::vector<TopicUse>{} : who.settings->writes(s, who);
            return std::any_of(writes.begin(), writes.end(),
                               [](TopicUse const& use) { return use.type == "ChargingDecision"; });
        });
    }
};

/// One of ours that has declared what it is, and how the launcher reads its settings.
template <program::Declaration (*declare)()>
Program declared(std::unique_ptr<ProcessSettings> (*read)(Fields&)) {
    static program::Declaration const declaration = declare();
    return {declaration.name, declaration.description, declaration.role, read, &declaration};
}

/// One that needs nothing else; `describe` reads it, with the checks that are its own.
template <class Config, program::Declaration (*declare)()>
Program declared() {
    return declared<declare>([](Fields& f) -> std::unique_ptr<ProcessSettings> {
        Config config;
        describe(f, config);
        return std::make_unique<DeclaredSettings>(declare());
    });
}

class RecorderSettings final : public DeclaredSettings {
  public:
    static std::unique_ptr<ProcessSettings> read(Fields& f) { return std::make_unique<RecorderSettings>(f); }
    explicit RecorderSettings(Fields& f) : DeclaredSettings{recorder::recorder_declaration()} {
        describe_own(f, config_);
    }
    /// What the report computes from the recording of a run that was attacked or disturbed.
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::vector<SignalUse> out = DeclaredSettings::signals(s, process);
        if (is_disturbed(s.resolved)) {
            for (ConsequenceSignal& signal : consequence_signals({})) {
                out.push_back({std::move(signal.name), std::move(signal.unit), 0});
            }
        }
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const& s, Process const& process) const override {
        return s.record.samples ? recorded_topics(s, process) : std::vector<TopicUse>{};
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = DeclaredSettings::settings(s, process);
        node.set("file", Node::scalar("../data.mcap")); // beside the folder of the process files
        Node topics = Node::map();
        auto const idl = own_types(s);
        for (TopicUse const& use : reads(s, process)) {
            Node& topic = topics.set(use.topic, Node::map());
            topic.set("type", Node::scalar(use.type));
            if (auto const own = idl.find(use.type); own != idl.end()) {
                topic.set("idl", Node::quoted_text(own->second.string()));
            }
        }
        node.set("topics", std::move(topics));
        node.set("capture", capture(s, process, config_.compress));
        return node;
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        std::set<std::string> links;
        for (CapturePoint const& point : capture_points(s, process)) {
            links.insert({point.link, point.link_out});
        }
        links.erase(""); // not a ledger's
        std::vector<WireUse> out;
        for (std::string const& link : links) {
            for (std::uint16_t const ethertype :
                 {iec61850::kSvEthertype, iec61850::kGooseEthertype, ethernet::kIpEthertype}) {
                out.push_back({link, ethertype, "", true});
            }
        }
        return out;
    }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        std::vector<std::string> names;
        for (Link const& link : s.links) {
            names.push_back(link.name.name);
        }
        for (Ref const& link : process.capture) {
            check_name(link, names, fmt::format("process '{}' captures the link", process.name.name), diagnostics);
        }
        check_capture(s, process, diagnostics);
    }

    [[nodiscard]] std::vector<std::string> networks(Scenario const& s, Process const& process) const override {
        std::set<std::string> out;
        for (CapturePoint const& point : capture_points(s, process)) {
            if (!point.host.empty()) {
                out.insert(point.host);
            }
        }
        return {out.begin(), out.end()};
    }

  private:
    static Node capture(Scenario const& s, Process const& process, bool compress) {
        Node list = Node::sequence();
        for (CapturePoint const& point : capture_points(s, process)) {
            Node port = Node::map();
            port.set("name", Node::quoted_text(point.name));
            port.set("description", Node::quoted_text(point.description));
            port.set("interface", Node::quoted_text(point.interface));
            if (!point.host.empty()) {
                port.set("host", Node::quoted_text(point.host));
            }
            if (!point.link.empty()) {
                port.set("link", Node::quoted_text(point.link));
            }
            if (point.both_ways) {
                port.set("both_ways", Node::scalar("true"));
            }
            if (!point.link_out.empty()) {
                port.set("link_out", Node::quoted_text(point.link_out));
            }
            list.items.push_back(std::move(port));
        }
        Node node = Node::map();
        node.set("file", Node::scalar(compress ? "../bus.pcapng.gz" : "../bus.pcapng"));
        node.set("network_namespace", Node::quoted_text("/proc/1/ns/net")); // the supervisor's, who made the switches
        node.set("ports", std::move(list));
        return node;
    }

    recorder::RecorderConfig config_;
};

std::span<Program const> programs() {
    static std::array const all{
        declared<sim::sim_declaration>(SimSettings::read),
        declared<agents::EvConfig, agents::ev_declaration>(),
        declared<gateways::mu_declaration>(read_merging_unit),
        declared<relay::relay_declaration>(read_relay),
        declared<attacker::attacker_declaration>(read_attacker),
        declared<gateways::breaker_declaration>(read_breaker),
        declared<gateways::link_declaration>(read_link),
        declared<gateways::gateway_declaration>(read_gateway),
        declared<agents::MccaConfig, agents::mcca_declaration>(),
        declared<agents::fmu_declaration>(read_fmu),
        declared<recorder::recorder_declaration>(RecorderSettings::read),
        declared<monitor::monitor_declaration>(read_monitor),
        Program{"exec", "a program of your own", "member", read_exec},
    };
    return all;
}

} // namespace

Program const* find_program(std::string_view name) {
    auto const all = programs();
    auto const it = std::find_if(all.begin(), all.end(), [&](Program const& p) { return p.name == name; });
    return it == all.end() ? nullptr : &*it;
}

std::vector<std::string> program_names() {
    std::vector<std::string> out;
    for (Program const& program : programs()) {
        out.emplace_back(program.name);
    }
    return out;
}

bool is_common_key(std::string_view key) {
    return std::find(kCommonKeys.begin(), kCommonKeys.end(), key) != kCommonKeys.end();
}

config::Node own_settings(Process const& process) {
    Node out = Node::map();
    for (Node::Entry const& entry : process.node.entries) {
        if (!is_common_key(entry.key)) {
            out.entries.push_back(entry);
        }
    }
    return out;
}

} // namespace gridspace::launcher
