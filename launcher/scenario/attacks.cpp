// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/attacks.hpp"
#include "launcher/scenario/wire_use.hpp"

#include "agents/attacker/frame_forger.hpp"
#include "agents/attacker/goose_forger.hpp"
#include "agents/attacker/stream_condition.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "common/text.hpp"
#include "sim/gateway/gateway_config.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using attacker::AttackConfig;
using config::Diagnostics;
using config::Node;
using GooseKind = attacker::GooseAttackParams::Kind;

int width(Ref const& ref) {
    return static_cast<int>(ref.name.size());
}

void unknown(Ref const& ref, std::string const& what, std::vector<std::string> const& names, Diagnostics& diagnostics) {
    diagnostics.error(ref.where, fmt::format("{} '{}', which does not exist", what, ref.name),
                      spelling_hint(ref.name, names, "there are none"), width(ref));
}

std::vector<std::string> names_of(std::vector<streams::Stream> const& all) {
    std::vector<std::string> out;
    for (streams::Stream const& stream : all) {
        out.push_back(stream.name.name);
    }
    return out;
}

void check_attacker(Scenario const& s, AttackConfig const& a, Diagnostics& diagnostics) {
    Process const* process = s.find_process(a.by.name);
    std::vector<std::string> attackers;
    for (Process const& p : s.processes) {
        if (p.program.name == "gridspace-attacker") {
            attackers.push_back(p.name.name);
        }
    }
    if (process == nullptr) {
        unknown(a.by, fmt::format("attack '{}' is done by the process", a.name.name), attackers, diagnostics);
    } else if (process->program.name != "gridspace-attacker") {
        diagnostics.error(
            a.by.where,
            fmt::format("attack '{}' is done by '{}', which is a {}", a.name.name, a.by.name, process->program.name),
            "an attacker is a process with `program: gridspace-attacker`", width(a.by));
    }
}

/// By the real publisher.
bool is_sent_on(Scenario const& s, std::string const& stream, std::string const& link) {
    return std::ranges::any_of(s.hosts,
                               [&](Host const& host) { return stream_passes(s, stream, host.name.name, link, true); });
}

bool passes_either_way(Scenario const& s, std::string const& stream, std::string const& host, std::string const& link) {
    return stream_passes(s, stream, host, link, true) || stream_passes(s, stream, host, link, false);
}

/// A condition on another stream: it must be one, have what is waited for, and pass where the attacker sits.
void check_condition(Scenario const& s, AttackConfig const& a, Diagnostics& diagnostics) {
    Ref const& at = a.when->stream;
    streams::Stream const* stream = streams::find_stream(s.streams, at.name);
    if (stream == nullptr) {
        unknown(at, fmt::format("attack '{}' waits for the stream", a.name.name), names_of(s.streams), diagnostics);
        return;
    }
    if (stream->broken) {
        return; // said where it is declared
    }
    if (stream->udp) {
        diagnostics.error(at.where,
                          fmt::format("attack '{}' waits for '{}', which goes over UDP", a.name.name, at.name),
                          "attackers hear Ethernet frames only: a stream without `udp`", width(at));
        return;
    }
    auto const made = attacker::StreamCondition::create(*stream, a.name.name, *a.when, a.when->channels);
    if (!made) {
        diagnostics.error(at.where, made.error().message, made.error().remedy, width(at));
        return;
    }
    bool const in_cable = a.place == AttackConfig::Place::between;
    Process const* const attacker = s.find_process(a.by.name);
    if ((in_cable && a.between.size() != 2) || attacker == nullptr || attacker->program.name != "gridspace-attacker") {
        return; // said elsewhere
    }
    if (in_cable && !passes_either_way(s, at.name, a.between[0].name, a.between[1].name)) {
        diagnostics.error(at.where,
                          fmt::format("attack '{}' waits for '{}', which does not pass between '{}' and '{}'",
                                      a.name.name, at.name, a.between[0].name, a.between[1].name),
                          "a stream that a process of that host sends or receives there", width(at));
    } else if (!in_cable && attacker->interface.empty() && !is_sent_on(s, at.name, raw_link(s, *attacker))) {
        diagnostics.error(at.where,
                          fmt::format("attack '{}' waits for '{}', which nobody sends on '{}'", a.name.name, at.name,
                                      raw_link(s, *attacker)),
                          fmt::format("a stream of the link of '{}'", a.by.name), width(at));
    }
}

/// Where the man in the middle sits: the host is completed from a process, and frames of the stream must pass there.
void check_place(Scenario const& s, AttackConfig& a, Diagnostics& diagnostics) {
    bool const alters_only =
        (a.goose && (a.goose->kind == GooseKind::grayhole || a.goose->kind == GooseKind::stretch)) ||
        (a.frames && a.frames->kind != attacker::FrameAttackParams::Kind::flood);
    if (a.place == AttackConfig::Place::second_publisher) {
        if (alters_only) {
            diagnostics.error(
                a.name.where,
                fmt::format("attack '{}' alters what is on its way, and sits beside the publisher", a.name.name),
                "place: {between: [HOST, LINK]}", width(a.name));
        }
        return;
    }
    if (!a.topic.empty()) {
        diagnostics.error(
            a.topic.where,
            fmt::format("attack '{}' sits in a cable, and '{}' is a DDS topic", a.name.name, a.topic.name),
            "topics are attacked beside their publisher: place: second_publisher", width(a.topic));
        return;
    }
    if (a.between.size() != 2) {
        return; // said when it was read
    }
    bool const link_is_there =
        std::any_of(s.links.begin(), s.links.end(), [&](Link const& l) { return l.name == a.between[1]; });
    if (!link_is_there || streams::find_stream(s.streams, a.stream.name) == nullptr) {
        return; // said elsewhere
    }
    Ref& at = a.between[0];
    std::vector<std::string> hosts;
    for (Host const& host : s.hosts) {
        hosts.push_back(host.name.name);
    }
    if (std::find(hosts.begin(), hosts.end(), at.name) == hosts.end()) {
        if (Process const* process = s.find_process(at.name)) {
            at.name = process->host.name;
        } else {
            return; // the check of the bump in the wire itself says it
        }
    }
    if (!passes_either_way(s, a.stream.name, at.name, a.between[1].name)) {
        diagnostics.error(at.where,
                          fmt::format("attack '{}': no process of host '{}' sends or receives the stream '{}' on '{}'",
                                      a.name.name, at.name, a.stream.name, a.between[1].name),
                          "the place is between the publisher's or a subscriber's host and the link", width(at));
    }
}

void check_stream(Scenario const& s, AttackConfig const& a, Diagnostics& diagnostics) {
    streams::Stream const* stream = streams::find_stream(s.streams, a.stream.name);
    if (stream == nullptr) {
        unknown(a.stream, fmt::format("attack '{}' is on the stream", a.name.name), names_of(s.streams), diagnostics);
        return;
    }
    if (stream->broken) {
        return; // said where it is declared
    }
    if (stream->udp) {
        diagnostics.error(a.stream.where,
                          fmt::format("attack '{}' is on '{}', which goes over UDP", a.name.name, a.stream.name),
                          "attacks forge Ethernet frames only: a stream without `udp`", width(a.stream));
        return;
    }
    bool const smv = stream->kind == streams::Kind::smv;
    if (smv == a.goose.has_value()) {
        diagnostics.error(a.stream.where,
                          fmt::format("attack '{}' is on '{}', a stream of kind {}", a.name.name, a.stream.name,
                                      smv ? "smv" : "goose"),
                          smv ? "such an attack has `value` or `frames`" : "such an attack has `message`",
                          width(a.stream));
        return;
    }
    if (a.until_s <= a.from_s) {
        return; // said when it was read
    }
    double const frequency_hz = s.network ? s.network->frequency_hz : 60;
    auto const complain = [&](Error const& error) {
        diagnostics.error(a.name.where, error.message, error.remedy, width(a.name));
    };
    if (a.frames) {
        if (auto const made = attacker::FrameForger::create(*stream, a, 0); !made) {
            complain(made.error());
        }
    } else if (smv) {
        if (auto const made = attacker::SvForger::create(*stream, a, frequency_hz, 0); !made) {
            complain(made.error());
        }
    } else if (auto const made = attacker::GooseForger::create(*stream, a, 0); !made) {
        complain(made.error());
    }
}

void check_topic(Scenario const& s, AttackConfig const& a, Diagnostics& diagnostics) {
    std::string const type = attacked_type(s, a.topic.name);
    if (type.empty()) {
        std::vector<std::string> names;
        if (Process const* simulator = s.simulator(); simulator != nullptr && simulator->settings != nullptr) {
            for (auto const& uses :
                 {simulator->settings->writes(s, *simulator), simulator->settings->reads(s, *simulator)}) {
                for (TopicUse const& use : uses) {
                    if (use.type == "LineCurrents" || use.type == "TripCommand") {
                        names.push_back(use.topic);
                    }
                }
            }
        }
        unknown(a.topic, fmt::format("attack '{}' is on the topic of line currents or trip commands", a.name.name),
                names, diagnostics);
    } else if ((type == "TripCommand") != a.goose.has_value() || a.frames) {
        diagnostics.error(
            a.topic.where, fmt::format("attack '{}' is on '{}', a topic of type {}", a.name.name, a.topic.name, type),
            type == "TripCommand" ? "such an attack has `message`" : "such an attack has `value`", width(a.topic));
    } else if (!a.goose) {
        double const rate_hz = sim::read_sampling(s.simulation.sampling, diagnostics).rate_hz.to_double();
        if (auto const made = attacker::make_sample_attack(a, {"Ia", "Ib", "Ic"}, rate_hz,
                                                           s.network ? s.network->frequency_hz : 60, 0);
            !made) {
            diagnostics.error(a.name.where, made.error().message, made.error().remedy, width(a.name));
        }
    }
}

} // namespace

void spell_out_places(Node& root) {
    Node* attacks = root.find("attacks");
    if (attacks == nullptr || !attacks->is_map()) {
        return;
    }
    for (Node::Entry& attack : attacks->entries) {
        Node* place = attack.value.is_map() ? attack.value.find("place") : nullptr;
        if (place != nullptr && place->text == "second_publisher") {
            Node spelled = Node::map(place->where);
            spelled.set("second_publisher", Node::scalar("true"));
            *place = std::move(spelled);
        }
    }
}

std::vector<AttackConfig const*> attacks_of(Scenario const& scenario, Process const& process) {
    std::vector<AttackConfig const*> out;
    for (AttackConfig const& attack : scenario.attacks) {
        if (attack.by.name == process.name.name) {
            out.push_back(&attack);
        }
    }
    return out;
}

std::string attacked_type(Scenario const& scenario, std::string const& topic) {
    Process const* simulator = scenario.simulator();
    if (simulator == nullptr || simulator->settings == nullptr) {
        return {};
    }
    for (auto const& uses :
         {simulator->settings->writes(scenario, *simulator), simulator->settings->reads(scenario, *simulator)}) {
        for (TopicUse const& use : uses) {
            if (use.topic == topic && (use.type == "LineCurrents" || use.type == "TripCommand")) {
                return use.type;
            }
        }
    }
    return {};
}

bool stream_passes(Scenario const& scenario, std::string const& stream, std::string const& host,
                   std::string const& link, bool sent) {
    return std::any_of(scenario.processes.begin(), scenario.processes.end(), [&](Process const& process) {
        if (process.settings == nullptr || process.host.name != host || process.program.name == "gridspace-attacker") {
            return false;
        }
        std::vector<WireUse> const uses = sent ? frames_sent(scenario, process) : frames_received(scenario, process);
        return std::any_of(uses.begin(), uses.end(),
                           [&](WireUse const& use) { return use.stream == stream && use.link == link; });
    });
}

void check_attacks(Scenario& s, Diagnostics& diagnostics) {
    double const duration_s = s.simulation.duration().to_double();
    for (AttackConfig& a : s.attacks) {
        check_attacker(s, a, diagnostics);
        if (!a.stream.empty()) {
            check_stream(s, a, diagnostics);
        } else if (!a.topic.empty()) {
            check_topic(s, a, diagnostics);
        }
        check_place(s, a, diagnostics);
        if (a.waits_for_other() && a.topic.empty()) {
            check_condition(s, a, diagnostics);
        }
        if (duration_s > 0 && a.from_s.to_double() >= duration_s) {
            diagnostics.warning(a.name.where,
                                fmt::format("attack '{}' from {} s on never happens: the run ends at {} s", a.name.name,
                                            shortest(a.from_s.to_double()), shortest(duration_s)),
                                "", width(a.name));
        }
    }
}

} // namespace gridspace::launcher
