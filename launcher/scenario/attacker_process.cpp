// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attacker_config.hpp"
#include "common/text.hpp"
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using attacker::AttackConfig;
using config::Diagnostics;
using config::Fields;
using config::Node;

class AttackerProcess final : public ProcessSettings {
  public:
    explicit AttackerProcess(Fields& f) { describe(f, config_); }

    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        std::vector<AttackConfig const*> const own = attacks_of(s, process);
        if (own.empty()) {
            diagnostics.warning(
                process.name.where,
                fmt::format("process '{}' is an attacker, and no attack is done by it", process.name.name),
                "`by:` of an entry of `attacks:` names it", static_cast<int>(process.name.name.size()));
        }
        if (std::any_of(own.begin(), own.end(), [](AttackConfig const* a) { return beside_a_stream(*a); })) {
            check_raw_link(s, process, diagnostics);
        }
        check_bumps(s, process, diagnostics);
        if (!process.interface.empty() && process.interface != s.allow_attacks_on) {
            diagnostics.error(
                process.name.where,
                fmt::format("process '{}' attacks on '{}', which is not a virtual cable", process.name.name,
                            process.interface),
                fmt::format("forged frames can operate real switchgear; if that is meant: --allow-attacks-on {}",
                            process.interface),
                static_cast<int>(process.name.name.size()));
        }
    }

    [[nodiscard]] std::vector<TopicUse> writes(Scenario const& s, Process const& process) const override {
        std::vector<TopicUse> out{{"signals", "SignalFrame"}, {"signal_catalog", "SignalCatalog"}};
        if (!config_.labels.empty()) {
            out.push_back({config_.labels, "AttackLabel"});
        }
        for (TopicUse const& use : attacked_topics(s, process)) {
            out.push_back(use);
        }
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const& s, Process const& process) const override {
        std::vector<TopicUse> out = attacked_topics(s, process);
        for (TopicUse& use : out) {
            use.triggers = true;
            use.optional = true;
        }
        return out;
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return wires(s, process);
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        return wires(s, process);
    }

    [[nodiscard]] std::vector<BumpUse> bumps(Scenario const& s, Process const& process) const override {
        std::vector<BumpUse> out;
        for (AttackConfig const* a : attacks_of(s, process)) {
            if (a->place != AttackConfig::Place::between || a->between.size() != 2) {
                continue;
            }
            bool const from_host = stream_passes(s, a->stream.name, a->between[0].name, a->between[1].name, true);
            bool const to_host =
                !from_host && stream_passes(s, a->stream.name, a->between[0].name, a->between[1].name, false);
            auto same = std::find_if(out.begin(), out.end(), [&](BumpUse const& c) {
                return c.host == a->between[0] && c.link == a->between[1];
            });
            if (same == out.end()) {
                same = out.insert(out.end(), {a->between[0], a->between[1]});
            }
            same->from_host = same->from_host || from_host;
            same->to_host = same->to_host || to_host;
        }
        return out;
    }

    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::vector<SignalUse> out;
        for (AttackConfig const* a : attacks_of(s, process)) {
            out.push_back({"attack." + a->name.name + ".forged", "", 1});
            if (config_.labels.empty()) {
                continue;
            }
            std::string const prefix =
                "score." + a->name.name + "."; // of the report, where a detector watches the target
            for (char const* name : {"labels", "judged", "seen"}) {
                out.push_back({prefix + name, "", 0});
            }
            for (char const* name : {"detected_percent", "clear_detected_percent", "closed_loop_detected_percent"}) {
                out.push_back({prefix + name, "%", 0});
            }
            out.push_back({prefix + "delay_ms", "ms", 0});
            out.push_back({prefix + "alarmed", "", 0});
            out.push_back({prefix + "alarm_ms", "ms", 0});
        }
        bool const first = std::find_if(s.processes.begin(), s.processes.end(), [&](Process const& p) {
                               return p.program.name == process.program.name;
                           })->name == process.name;
        if (first && !config_.labels.empty()) { // of the run, whoever attacks
            for (char const* name : {"trips_lost", "trips_late", "trips_false", "openings_false"}) {
                out.push_back({std::string{"consequence."} + name, "", 0});
            }
            out.push_back({"consequence.slowest_trip_ms", "ms", 0});
            out.push_back({"consequence.load_not_served_kw", "kW", 0});
            out.push_back({"consequence.energy_not_served_wh", "Wh", 0});
        }
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }

    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = own_settings(process);
        Node attacks = Node::map(), declared = Node::map(), types = Node::map();
        for (AttackConfig const* a : attacks_of(s, process)) {
            Node attack = *s.resolved.find("attacks")->find(a->name.name);
            if (a->place == AttackConfig::Place::between) { // a place that was named by a process is its host's
                Node between = Node::sequence();
                between.items = {Node::scalar(a->between[0].name), Node::scalar(a->between[1].name)};
                attack.find("place")->set("between", std::move(between));
            }
            if (!a->recording.empty()) { // the process reads its settings from somewhere else
                attack.find("value")
                    ->find("recording")
                    ->set("file",
                          Node::quoted_text(std::filesystem::absolute(a->recording).lexically_normal().string()));
            }
            attacks.set(a->name.name, std::move(attack));
            if (Node const* all = s.resolved.find("streams"); all != nullptr && !a->stream.empty()) {
                if (Node const* stream = all->find(a->stream.name)) {
                    declared.set(a->stream.name, *stream);
                }
            }
            if (!a->topic.empty()) {
                types.set(a->topic.name, Node::map()).set("type", Node::scalar(attacked_type(s, a->topic.name)));
            }
        }
        node.set("attacks", std::move(attacks));
        node.set("streams", std::move(declared));
        node.set("topic_types", std::move(types));
        node.set("seed", Node::scalar(std::to_string(s.seed)));
        node.set("frequency_hz", Node::scalar(shortest(s.network ? s.network->frequency_hz : 60)));
        Node wire = wires(s, process).empty() ? Node::map() : wire_settings(s, process);
        if (wire.find("interface") == nullptr) {
            wire.set("interface", Node::quoted_text(""));
        }
        node.set("wire", std::move(wire));
        node.set("bumps", bump_settings(s, process));
        if (s.clock.mode == bus::ClockMode::realtime && s.clock.speed > 0) {
            node.set("speed", Node::scalar(shortest(s.clock.speed)));
        }
        if (!s.allow_attacks_on.empty()) {
            node.set("allow_attacks_on", Node::quoted_text(s.allow_attacks_on));
        }
        return node;
    }

  private:
    static bool beside_a_stream(AttackConfig const& a) {
        return a.place == AttackConfig::Place::second_publisher && !a.stream.empty();
    }

    [[nodiscard]] static std::vector<TopicUse> attacked_topics(Scenario const& s, Process const& process) {
        std::vector<TopicUse> out;
        for (AttackConfig const* a : attacks_of(s, process)) {
            if (std::string const type = a->topic.empty() ? "" : attacked_type(s, a->topic.name); !type.empty()) {
                auto const same = std::find_if(out.begin(), out.end(),
                                               [&](TopicUse const& use) { return use.topic == a->topic.name; });
                if (same == out.end()) {
                    out.push_back({a->topic.name, type});
                } else {
                    ++same->endpoints; // each attack has its own reader and writer
                }
            }
        }
        return out;
    }

    /// A second publisher listens to what it sends.
    [[nodiscard]] static std::vector<WireUse> wires(Scenario const& s, Process const& process) {
        std::vector<WireUse> out;
        for (AttackConfig const* a : attacks_of(s, process)) {
            streams::Stream const* stream =
                beside_a_stream(*a) ? streams::find_stream(s.streams, a->stream.name) : nullptr;
            if (stream != nullptr) {
                out.push_back({raw_link(s, process), stream->ethertype(), a->stream.name});
            }
        }
        return out;
    }

    attacker::AttackerConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_attacker(Fields& f) {
    return std::make_unique<AttackerProcess>(f);
}

} // namespace gridspace::launcher
