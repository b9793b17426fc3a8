// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/wire_use.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/frame.hpp"
#include "gateways/port/wire_config.hpp"
#include "gateways/prp/redundancy_trailer.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/bumps.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::launcher {
namespace {

std::vector<std::string> links_of(Scenario const& scenario, Process const& process, bool without_ip) {
    std::vector<std::string> out;
    for (Host const& host : scenario.hosts) {
        if (host.name != process.host) {
            continue;
        }
        for (Ref const& ref : host.links) {
            auto const link = std::find_if(scenario.links.begin(), scenario.links.end(),
                                           [&](Link const& l) { return l.name == ref; });
            if (link != scenario.links.end() && (!without_ip || link->ipv4.empty())) {
                out.push_back(ref.name);
            }
        }
    }
    return out;
}

/// Of a doubly attached node also on network B.
std::vector<WireUse> on_both(Process const& process, std::vector<WireUse> uses) {
    std::size_t const alone = process.prp.size() < 2 ? 0 : uses.size();
    for (std::size_t i = 0; i < alone; ++i) {
        if (uses[i].link == process.prp[0].name && !uses[i].at_switch) {
            uses.push_back(uses[i]);
            uses.back().link = process.prp[1].name;
        }
    }
    return uses;
}

void check_prp(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) {
    auto const wrong = [&](Ref const& at, std::string_view what, std::string const& hint) {
        diagnostics.error(at.where, fmt::format("process '{}' {}", process.name.name, what), hint,
                          static_cast<int>(at.name.size()));
    };
    Ref const& a = process.prp.front();
    Ref const& b = process.prp.back();
    if (!process.link.empty() || !process.interface.empty()) {
        wrong(a, fmt::format("has `prp` and `{}`", process.link.empty() ? "interface" : "link"),
              "leave one of them out");
    }
    if (process.prp.size() != 2 || a.name == b.name) {
        wrong(a, "is not on two networks", "prp: [the link that is network A, the one that is network B]");
    }
    if (process.is_foreign() && !process.settings->is_daemon()) {
        wrong(a, "is a program of its own, which would have to speak PRP itself", "a process of ours, or a `link`");
    }
    if (process.run_on != "native" && process.run_on != "qemu-user") {
        wrong(a, fmt::format("runs on {}, where it has one cable", process.run_on), "run_on: native, or a `link`");
    }
    auto const all = links_of(scenario, process, false);
    for (Ref const& link : process.prp) {
        if (std::find(all.begin(), all.end(), link.name) == all.end()) {
            wrong(link,
                  fmt::format("exchanges raw frames on '{}', and host '{}' is not plugged into it", link.name,
                              process.host.name),
                  all.empty() ? "" : fmt::format("it is plugged into {}", join(all, ", ")));
        }
    }
}

/// Link and interface of a place on a link; on a link of the scenario.
config::Node place_settings(Scenario const& scenario, Process const& process, std::string const& link) {
    config::Node node = config::Node::map();
    std::string const sent_on = piece_sent_on(scenario, process.host.name, link),
                      received_on = piece_received_on(scenario, process.host.name, link);
    node.set("link", config::Node::quoted_text(sent_on));
    if (received_on != sent_on) {
        node.set("receive_link", config::Node::quoted_text(received_on));
    }
    for (Port const& port : plan_ports(scenario)) {
        if (port.host == process.host.name && port.link == link) {
            node.set("interface", config::Node::quoted_text(port.interface));
        }
    }
    return node;
}

} // namespace

std::vector<WireUse> frames_sent(Scenario const& scenario, Process const& process) {
    return on_both(process, process.settings->sends(scenario, process));
}

std::vector<WireUse> frames_received(Scenario const& scenario, Process const& process) {
    return on_both(process, process.settings->receives(scenario, process));
}

std::string raw_link(Scenario const& scenario, Process const& process) {
    if (!process.prp.empty()) {
        return process.prp.front().name;
    }
    if (!process.link.empty()) {
        return process.link.name;
    }
    for (bool const without_ip : {true, false}) {
        if (auto const links = links_of(scenario, process, without_ip); links.size() == 1) {
            return links.front();
        }
    }
    return {};
}

void check_raw_link(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) {
    if (!process.prp.empty()) {
        check_prp(scenario, process, diagnostics);
        return;
    }
    if (!process.interface.empty()) {
        return; // outside of all links
    }
    std::string const link = raw_link(scenario, process);
    auto const all = links_of(scenario, process, false);
    if (!link.empty() && std::find(all.begin(), all.end(), link) != all.end()) {
        return;
    }
    Ref const at = process.link.empty() ? process.name : process.link;
    diagnostics.error(
        at.where,
        link.empty()
            ? fmt::format("process '{}' exchanges raw frames, and it is not clear on which link", process.name.name)
            : fmt::format("process '{}' exchanges raw frames on '{}', and host '{}' is not plugged into it",
                          process.name.name, link, process.host.name),
        all.empty() ? fmt::format("host '{}' is plugged into no link", process.host.name)
                    : fmt::format("`link:` one of {}", join(all, ", ")),
        static_cast<int>(at.name.size()));
}

void check_room_for_trailers(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) {
    constexpr std::size_t kRoom = iec61850::kMaxLength - prp::kTrailerOctets;
    std::set<std::string> seen; // it is sent on both networks
    for (WireUse const& use : frames_sent(scenario, process)) {
        streams::Stream const* const stream = streams::find_stream(scenario.streams, use.stream);
        if (process.prp.empty() || stream == nullptr || !seen.insert(use.stream).second ||
            stream->longest_payload() <= kRoom) {
            continue;
        }
        diagnostics.error(
            stream->name.where,
            fmt::format("a frame of stream '{}' could have {} octets behind the ethertype, and '{}' sends "
                        "it with `prp`",
                        stream->name.name, stream->longest_payload(), process.name.name),
            fmt::format("with the redundancy trailer there is room for {}: fewer samples_per_frame or "
                        "members",
                        kRoom),
            static_cast<int>(stream->name.name.size()));
    }
}

config::Node wire_settings(Scenario const& scenario, Process const& process) {
    config::Node node = place_settings(scenario, process, raw_link(scenario, process));
    if (scenario.clock.mode == bus::ClockMode::realtime && scenario.clock.speed > 0) {
        node.set("speed", config::Node::scalar(shortest(scenario.clock.speed)));
    }
    if (!process.interface.empty()) {
        node.set("interface", config::Node::quoted_text(process.interface));
    }
    if (process.prp.size() == 2) {
        node.set("prp_lan_b", place_settings(scenario, process, process.prp.back().name));
    }
    return node;
}

void check_samples_on_steps(Scenario const& s, streams::Stream const& stream, Ref const& ref,
                            config::Diagnostics& diagnostics) {
    if (s.clock.mode != bus::ClockMode::lockstep || stream.kind != streams::Kind::smv ||
        (Rational{1} / stream.rate_hz / s.quantum_s()).is_whole()) {
        return;
    }
    diagnostics.error(ref.where,
                      fmt::format("in lockstep the samples of '{}' ({} Hz) must fall on the simulator's "
                                  "steps, and the time quantum is {} s",
                                  stream.name.name, stream.rate_hz.to_string(), s.quantum_s().to_string()),
                      "simulation.step_s: a whole part of the sample period",
                      static_cast<int>(stream.name.name.size()));
}

bool has_raw_frames(Scenario const& scenario) {
    return std::any_of(scenario.processes.begin(), scenario.processes.end(), [&](Process const& process) {
        return process.settings != nullptr &&
               (process.settings->is_guest() || !frames_sent(scenario, process).empty() ||
                !frames_received(scenario, process).empty());
    });
}

streams::Stream const* must_be_stream(Scenario const& s, config::Ref const& ref, streams::Kind kind,
                                      config::Diagnostics& diagnostics) {
    return gateways::stream_of(s.streams, ref, kind, diagnostics);
}

void must_have_member(streams::Stream const* stream, std::string const& member, config::Ref const& at, bool boolean,
                      config::Diagnostics& diagnostics) {
    if (stream == nullptr) {
        return;
    }
    std::vector<std::string> names;
    for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream->data_set)) {
        bool const suits = boolean ? leaf.type == iec61850::BasicType::boolean : iec61850::is_number(leaf.type);
        if (leaf.name == member && suits) {
            return;
        }
        if (leaf.name == member) {
            diagnostics.error(at.where,
                              fmt::format("member '{}' of stream '{}' is of type {}", member, stream->name.name,
                                          iec61850::type_name(leaf.type)),
                              boolean ? "expected boolean" : "expected a number", static_cast<int>(at.name.size()));
            return;
        }
        names.push_back(leaf.name);
    }
    diagnostics.error(at.where, fmt::format("stream '{}' has no member '{}'", stream->name.name, member),
                      spelling_hint(member, names), static_cast<int>(at.name.size()));
}

WireUse use_of(Scenario const& s, Process const& process, config::Ref const& stream) {
    streams::Stream const* found = streams::find_stream(s.streams, stream.name);
    return {raw_link(s, process), found == nullptr ? std::uint16_t{0} : found->ethertype(), stream.name};
}

} // namespace gridspace::launcher
