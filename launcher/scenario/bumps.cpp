// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/wire_use.hpp"

#include "common/text.hpp"
#include "gateways/ethernet/boxed_ip.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;
using Way = PlacedBump::Way;

/// string<32> of WireLedgerEntry.
constexpr std::size_t kLongestPiece = 32;

std::string piece_from(std::string const& host, std::string const& link) {
    return host + ">" + link;
}
std::string piece_to(std::string const& host, std::string const& link) {
    return link + ">" + host;
}

/// Ethertypes that the processes of a host send or receive on a link.
std::vector<std::uint16_t> ethertypes_of(Scenario const& scenario, std::string const& host, std::string const& link,
                                         bool sent) {
    std::vector<std::uint16_t> out;
    for (Process const& process : scenario.processes) {
        if (process.settings == nullptr || process.host.name != host) {
            continue;
        }
        for (WireUse const& use : sent ? frames_sent(scenario, process) : frames_received(scenario, process)) {
            if (use.link == link && !use.at_switch && std::find(out.begin(), out.end(), use.ethertype) == out.end()) {
                out.push_back(use.ethertype);
            }
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

/// Names the pieces of one cable in one direction: `first` where frames enter it, `last` where they leave it.
void name_pieces(std::vector<std::optional<Way>*> const& ways, std::string const& first, std::string const& last) {
    std::string const stem = first.find('>') != std::string::npos ? first : last;
    auto const cuts = std::ranges::count_if(ways, [](auto const* way) { return !(*way)->only_heard; });
    std::ptrdiff_t passed = 0;
    auto const piece = [&] { return passed == 0 ? first : passed == cuts ? last : fmt::format("{}.{}", stem, passed); };
    for (std::optional<Way>* way : ways) {
        (*way)->in = piece();
        if (!(*way)->only_heard) {
            ++passed;
            (*way)->out = piece();
        }
    }
}

Node way_settings(Way const& way) {
    Node node = Node::map();
    node.set("in", Node::quoted_text(way.in));
    node.set("out", Node::quoted_text(way.out));
    for (std::uint16_t const ethertype : way.ethertypes) {
        node.set(ethertype == iec61850::kSvEthertype   ? "smv"
                 : ethertype == ethernet::kIpEthertype ? "ip"
                                                       : "goose",
                 Node::scalar("true"));
    }
    return node;
}

/// The piece of cable into which a host sends on a link, or from which it receives.
std::string piece_of(std::vector<PlacedBump> const& bumps, std::string const& host, std::string const& link,
                     bool sent) {
    bool const cut = std::ranges::any_of(bumps, [&](PlacedBump const& bump) {
        std::optional<Way> const& way = sent ? bump.from_host : bump.to_host;
        return bump.host == host && bump.link == link && way && !way->only_heard;
    });
    return !cut ? link : sent ? piece_from(host, link) : piece_to(host, link);
}

std::vector<WireUse> with_pieces(std::vector<PlacedBump> const& bumps, Process const& process,
                                 std::vector<WireUse> uses, bool sent) {
    for (WireUse& use : uses) {
        if (!use.at_switch) {
            use.link = piece_of(bumps, process.host.name, use.link, sent);
        }
    }
    for (PlacedBump const& bump : bumps) {
        if (bump.process != process.name.name) {
            continue;
        }
        for (auto const* way : {&bump.from_host, &bump.to_host}) {
            if (way->has_value() && !(sent && (*way)->only_heard)) {
                for (std::uint16_t const ethertype : (*way)->ethertypes) {
                    uses.push_back({sent ? (*way)->out : (*way)->in, ethertype, ""});
                }
            }
        }
    }
    return uses;
}

} // namespace

std::vector<PlacedBump> placed_bumps(Scenario const& scenario) {
    std::vector<PlacedBump> out;
    for (Process const& process : scenario.processes) {
        if (process.settings == nullptr) {
            continue;
        }
        for (BumpUse const& use : process.settings->bumps(scenario, process)) {
            PlacedBump bump;
            bump.process = process.name.name;
            bump.process_host = process.host.name;
            bump.host = use.host.name;
            bump.link = use.link.name;
            bump.host_interface = fmt::format("cut{}_host", out.size());
            bump.switch_interface = fmt::format("cut{}_switch", out.size());
            if (use.from_host) {
                bump.from_host = Way{"", "", ethertypes_of(scenario, bump.host, bump.link, true)};
            }
            if (use.to_host) {
                bump.to_host = Way{"", "", ethertypes_of(scenario, bump.host, bump.link, false)};
            } else if (!use.heard_to_host.empty()) {
                std::set<std::uint16_t> const once{use.heard_to_host.begin(), use.heard_to_host.end()};
                bump.to_host = Way{"", "", {once.begin(), once.end()}, true};
            }
            out.push_back(std::move(bump));
        }
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        auto const same_cable = [&](PlacedBump const& other) {
            return other.host == out[i].host && other.link == out[i].link;
        };
        if (std::any_of(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(i), same_cable)) {
            continue; // named with the first one of the cable
        }
        std::vector<std::optional<Way>*> from, to;
        for (PlacedBump& bump : out) {
            if (!same_cable(bump)) {
                continue;
            }
            if (bump.from_host) {
                from.push_back(&bump.from_host);
            }
            if (bump.to_host) {
                to.insert(to.begin(), &bump.to_host); // the one next to the switch sees it first
            }
        }
        name_pieces(from, piece_from(out[i].host, out[i].link), out[i].link);
        name_pieces(to, out[i].link, piece_to(out[i].host, out[i].link));
    }
    return out;
}

std::string piece_sent_on(Scenario const& scenario, std::string const& host, std::string const& link) {
    return piece_of(placed_bumps(scenario), host, link, true);
}

std::string piece_received_on(Scenario const& scenario, std::string const& host, std::string const& link) {
    return piece_of(placed_bumps(scenario), host, link, false);
}

std::vector<WireUse> wires_sent(Scenario const& scenario, Process const& process,
                                std::vector<PlacedBump> const& bumps) {
    return with_pieces(bumps, process, frames_sent(scenario, process), true);
}

std::vector<WireUse> wires_received(Scenario const& scenario, Process const& process,
                                    std::vector<PlacedBump> const& bumps) {
    return with_pieces(bumps, process, frames_received(scenario, process), false);
}

Node bump_settings(Scenario const& scenario, Process const& process) {
    Node list = Node::sequence();
    for (PlacedBump const& bump : placed_bumps(scenario)) {
        if (bump.process != process.name.name) {
            continue;
        }
        Node node = Node::map();
        node.set("host", Node::quoted_text(bump.host));
        node.set("link", Node::quoted_text(bump.link));
        node.set("host_interface", Node::quoted_text(bump.host_interface));
        node.set("switch_interface", Node::quoted_text(bump.switch_interface));
        if (bump.from_host) {
            node.set("from_host", way_settings(*bump.from_host));
        }
        if (bump.to_host) {
            node.set("to_host", way_settings(*bump.to_host));
        }
        list.items.push_back(std::move(node));
    }
    return list;
}

namespace {

int length_of(Ref const& ref) {
    return static_cast<int>(ref.name.size());
}

/// The place must be there, be one of another host, and have a short name. False: nothing else can be said of it.
bool check_place(Scenario const& scenario, Process const& process, BumpUse const& use,
                 config::Diagnostics& diagnostics) {
    std::vector<std::string> hosts, links;
    for (Host const& host : scenario.hosts) {
        hosts.push_back(host.name.name);
    }
    for (Link const& link : scenario.links) {
        links.push_back(link.name.name);
    }
    auto const must_be = [&](Ref const& ref, std::vector<std::string> const& names, std::string_view kind) {
        if (std::find(names.begin(), names.end(), ref.name) != names.end()) {
            return true;
        }
        diagnostics.error(ref.where,
                          fmt::format("process '{}' sits in a cable of the {} '{}', which does not exist",
                                      process.name.name, kind, ref.name),
                          spelling_hint(ref.name, names), length_of(ref));
        return false;
    };
    bool const host_is_there = must_be(use.host, hosts, "host");
    if (!must_be(use.link, links, "link") || !host_is_there) {
        return false;
    }
    Host const& host =
        *std::find_if(scenario.hosts.begin(), scenario.hosts.end(), [&](Host const& h) { return h.name == use.host; });
    if (std::find(host.links.begin(), host.links.end(), use.link) == host.links.end()) {
        diagnostics.error(use.link.where,
                          fmt::format("process '{}' sits between '{}' and '{}', and there is no cable",
                                      process.name.name, use.host.name, use.link.name),
                          fmt::format("host '{}' is not plugged into that link", use.host.name), length_of(use.link));
        return false;
    }
    if (piece_from(use.host.name, use.link.name).size() + 3 > kLongestPiece) {
        diagnostics.error(
            use.host.where,
            fmt::format("the names '{}' and '{}' are too long for a place between them", use.host.name, use.link.name),
            fmt::format("together at most {} characters", kLongestPiece - 4), length_of(use.host));
    }
    if (use.host == process.host) {
        diagnostics.error(
            use.host.where,
            fmt::format("process '{}' sits in a cable of its own host '{}'", process.name.name, use.host.name),
            "give it a host of its own: hosts: {NAME: {links: []}}", length_of(use.host));
    }
    return true;
}

/// In lockstep the ways that it takes must carry something, and not answer each other.
void check_ways(Scenario const& scenario, Process const& process, BumpUse const& use,
                config::Diagnostics& diagnostics) {
    auto const carries = [&](bool sent) {
        return !ethertypes_of(scenario, use.host.name, use.link.name, sent).empty();
    };
    if (use.from_host && use.to_host) { // one of them may be empty
        if (carries(true) && carries(false)) {
            diagnostics.error(
                use.host.where,
                fmt::format("process '{}' sits on both ways of '{}', which answers what it hears", process.name.name,
                            use.host.name),
                "in lockstep two entries are needed, one with `direction: from_host` and one with `direction: to_host`",
                length_of(use.host));
        }
        return;
    }
    for (bool const sent : {true, false}) {
        if ((sent ? use.from_host : use.to_host) && !carries(sent)) {
            diagnostics.error(use.host.where,
                              fmt::format("process '{}' handles what '{}' {} '{}', and that is nothing",
                                          process.name.name, use.host.name, sent ? "sends on" : "receives from",
                                          use.link.name),
                              fmt::format("the other direction is `direction: {}`", sent ? "to_host" : "from_host"),
                              length_of(use.host));
        }
    }
}

} // namespace

void check_bumps(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics) {
    for (BumpUse const& use : process.settings->bumps(scenario, process)) {
        if (check_place(scenario, process, use, diagnostics) && scenario.clock.mode == bus::ClockMode::lockstep) {
            check_ways(scenario, process, use, diagnostics);
        }
    }
}

} // namespace gridspace::launcher
