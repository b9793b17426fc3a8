// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/member/member_config.hpp"

#include "gateways/ethernet/boxed_ip.hpp"

#include <arpa/inet.h>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::timebox {
namespace {

void describe_frames(config::Fields& f, std::string_view key, std::vector<std::uint16_t>& ethertypes,
                     std::string_view doc) {
    std::vector<config::Ref> words;
    f.references(key, words, {.doc = doc});
    for (config::Ref const& word : words) {
        if (word.name == "ip") {
            ethertypes.push_back(ethernet::kIpEthertype);
        } else if (word.name == "smv" || word.name == "goose") {
            ethertypes.push_back(word.name == "smv" ? iec61850::kSvEthertype : iec61850::kGooseEthertype);
        } else {
            f.error(key, fmt::format("'{}' is no kind of frame", word.name), "smv, goose or ip");
        }
    }
}

std::optional<std::uint32_t> address_of(std::string const& text) {
    in_addr out{};
    return ::inet_pton(AF_INET, text.c_str(), &out) == 1 ? std::optional{ntohl(out.s_addr)} : std::nullopt;
}

MacOctets mac_of(config::Fields& f, std::string_view key, std::string const& text) {
    auto const mac = iec61850::Mac::parse(text);
    if (!mac) {
        f.error(key, fmt::format("'{}' is no MAC address", text));
    }
    return mac.value_or(iec61850::Mac{}).octets;
}

void describe_ip(config::Fields& f, IpLink& ip) {
    std::string address, mac;
    f.text("address", address, {.doc = "IPv4 address and length of the prefix", .required = true});
    f.text("mac", mac, {.doc = "where its frames come from and go to", .required = true});
    std::size_t const slash = address.find('/');
    auto const own = address_of(address.substr(0, slash));
    int prefix = -1;
    if (slash != std::string::npos) {
        std::from_chars(address.data() + slash + 1, address.data() + address.size(), prefix);
    }
    if (!own || prefix < 0 || prefix > 32) {
        f.error("address", fmt::format("'{}' is no address with a prefix", address), "for example 10.10.0.1/24");
    }
    ip.address = own.value_or(0);
    ip.prefix = prefix;
    ip.mac = mac_of(f, "mac", mac);
    std::map<std::string, std::string> neighbours;
    config::Node node;
    f.raw("neighbours", node, {.doc = "MAC address by IPv4 address of everybody else on the link"});
    for (auto const& entry : node.entries) {
        auto const other = address_of(entry.key);
        if (!other) {
            f.error("neighbours", fmt::format("'{}' is no IPv4 address", entry.key));
            continue;
        }
        ip.neighbours[*other] = mac_of(f, "neighbours", entry.value.text);
    }
}

} // namespace

void describe(config::Fields& f, MemberConfig& c) {
    std::vector<config::Ref> words;
    f.references("command", words, {.doc = "the program and its arguments", .required = true, .may_be_empty = true});
    for (config::Ref& word : words) {
        c.command.push_back(std::move(word.name));
    }
    f.integer("seed", c.seed, {.doc = "of the random numbers that the program gets, with its name"});
    f.fraction("latency_us", c.latency_us, {.doc = "computing delay of what it sends", .min = 0});
    describe_frames(f, "sends", c.sends, "kinds of frames that it sends: smv, goose, ip");
    describe_frames(f, "receives", c.receives, "kinds of frames that it receives");
    f.object("ip", {.doc = "its IP on the link, in simulated time"},
             [&](config::Fields& i) { describe_ip(i, c.ip.emplace()); });
    auto const topics = [&](std::string_view key, std::vector<BoxedTopic>& list, std::string_view doc) {
        f.map(key, {.doc = doc}, [&](config::Ref const& name, config::Fields& t) {
            BoxedTopic& topic = list.emplace_back();
            topic.topic = name.name;
            t.text("type", topic.type, {.doc = "name of the type on the wire", .required = true});
            t.file("idl", topic.idl, {.doc = "IDL file that defines the type, when it is not one of ours"});
        });
    };
    topics("reads", c.reads, "topics of DDS that it reads");
    topics("writes", c.writes, "topics of DDS that it writes");
    f.integer("dds_domain", c.dds_domain,
              {.doc = "domain of DDS in which it is, within its box", .min = 0, .max = 232});
    if (f.has("wire") || !c.sends.empty() || !c.receives.empty()) {
        gateways::describe_wire(f, c.wire);
    }
}

} // namespace gridspace::timebox
