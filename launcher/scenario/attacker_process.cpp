// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attacker_declaration.hpp"
#include "common/text.hpp"
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/declared_program.hpp"
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

class AttackerProcess final : public DeclaredSettings {
  public:
    explicit AttackerProcess(Fields& f) : DeclaredSettings{attacker::attacker_declaration()} { describe(f, config_); }

    void settle(Scenario const& s, Process const& process) override {
        declare(attacker::declaration(config_, attacks_of(s, process),
                                      [&](std::string const& topic) { return attacked_type(s, topic); }));
    }

    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        std::vector<AttackConfig const*> const own = attacks_of(s, process);
        if (own.empty()) {
            diagnostics.warning(
                process.name.where,
                fmt::format("process '{}' is an attacker, and no attack is done by it", process.name.name),
                "`by:` of an entry of `attacks:` names it", static_cast<int>(process.name.name.size()));
        }
        if (!sends(s, process).empty()) {
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

    [[nodiscard]] std::vector<BumpUse> bumps(Scenario const& s, Process const& process) const override {
        std::vector<BumpUse> out;
        for (AttackConfig const* a : attacks_of(s, process)) {
            if (a->place != AttackConfig::Place::between || a->between.size() != 2) {
                continue;
            }
            auto same = std::find_if(out.begin(), out.end(), [&](BumpUse const& c) {
                return c.host == a->between[0] && c.link == a->between[1];
            });
            if (same == out.end()) {
                same = out.insert(out.end(), {a->between[0], a->between[1]});
            }
            bool const from_host = comes_from_host(s, a->stream.name, *a);
            same->from_host = same->from_host || from_host;
            same->to_host = same->to_host || (!from_host && goes_to_host(s, a->stream.name, *a));
            if (a->waits_for_other() && comes_from_host(s, a->when->stream.name, *a)) {
                same->from_host = true;
            } else if (a->waits_for_other() && goes_to_host(s, a->when->stream.name, *a)) { // untouched if it can be
                same->heard_to_host.push_back(a->when->said ? iec61850::kGooseEthertype : iec61850::kSvEthertype);
            }
        }
        return out;
    }

    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::vector<SignalUse> out = DeclaredSettings::signals(s, process);
        if (config_.labels.empty()) {
            return out;
        }
        for (AttackConfig const* a : attacks_of(s, process)) { // of the report, where a detector watches the target
            std::string const prefix = "score." + a->name.name + ".";
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
        return out;
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = own_settings(process);
        Node attacks = Node::map(), declared = Node::map(), types = Node::map(), towards_host = Node::sequence();
        for (AttackConfig const* a : attacks_of(s, process)) {
            Node attack = *s.resolved.find("attacks")->find(a->name.name);
            if (a->place == AttackConfig::Place::between) { // a place that was named by a process is its host's
                if (!comes_from_host(s, a->stream.name, *a)) {
                    towards_host.items.push_back(Node::quoted_text(a->name.name));
                }
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
            Node const* const all = s.resolved.find("streams");
            for (std::string const& name : {a->stream.name, a->when ? a->when->stream.name : ""}) {
                if (Node const* stream = all == nullptr || name.empty() ? nullptr : all->find(name)) {
                    declared.set(name, *stream);
                }
            }
            if (!a->topic.empty()) {
                types.set(a->topic.name, Node::map()).set("type", Node::scalar(attacked_type(s, a->topic.name)));
            }
        }
        node.set("attacks", std::move(attacks));
        node.set("streams", std::move(declared));
        node.set("towards_host", std::move(towards_host));
        node.set("topic_types", std::move(types));
        node.set("seed", Node::scalar(std::to_string(s.seed)));
        node.set("frequency_hz", Node::scalar(shortest(s.network ? s.network->frequency_hz : 60)));
        Node wire = sends(s, process).empty() ? Node::map() : wire_settings(s, process);
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
    static bool comes_from_host(Scenario const& s, std::string const& stream, AttackConfig const& a) {
        return stream_passes(s, stream, a.between[0].name, a.between[1].name, true);
    }
    static bool goes_to_host(Scenario const& s, std::string const& stream, AttackConfig const& a) {
        return stream_passes(s, stream, a.between[0].name, a.between[1].name, false);
    }

    attacker::AttackerConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_attacker(Fields& f) {
    return std::make_unique<AttackerProcess>(f);
}

} // namespace gridspace::launcher
