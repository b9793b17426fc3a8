// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/streams/udp_address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

namespace gridspace::streams {
namespace {

std::optional<iec61850::Ipv4> read_address(config::Fields& f, char const* key, char const* doc, bool required) {
    std::string text;
    f.text(key, text, {.doc = doc, .required = required});
    auto const out = parse_ipv4(text);
    if (!text.empty() && !out) {
        f.error(key, fmt::format("'{}' is not an IPv4 address", text), "for example 239.192.0.21");
    }
    return out;
}

} // namespace

std::optional<iec61850::Ipv4> parse_ipv4(std::string const& text) {
    iec61850::Ipv4 out{};
    return ::inet_pton(AF_INET, text.c_str(), out.data()) == 1 ? std::optional{out} : std::nullopt;
}

bool is_routed_group(iec61850::Ipv4 const& address) {
    bool const this_network = address[0] == 224 && address[1] == 0 && address[2] == 0;
    return address[0] >= 224 && address[0] <= 239 && !this_network;
}

void describe(config::Fields& f, std::optional<UdpAddress>& udp) {
    UdpAddress read;
    std::int64_t ttl = read.ttl, dscp = read.dscp;
    bool const given = f.object(
        "udp", {.doc = "the stream goes over UDP to port 102 (R-GOOSE, R-SV) instead of in Ethernet frames of its own"},
        [&](config::Fields& u) {
            if (auto const group = read_address(u, "group", "IPv4 address of the group that it is sent to", true)) {
                read.group = *group;
                if (!is_routed_group(read.group)) {
                    u.error("group", "routers forward nothing to this address",
                            "a group: 224.0.1.0 to 239.255.255.255; 239.192.0.0/14 is an organisation's own");
                }
            }
            read.source = read_address(
                u, "source", "IPv4 address of the sender; without it that of its interface, or 169.254.x.y", false);
            u.integer("ttl", ttl, {.doc = "how many routers may forward it, plus one", .min = 1, .max = 255});
            u.integer("dscp", dscp, {.doc = "class of service of its datagrams; 46: expedited", .min = 0, .max = 63});
        });
    if (given) {
        read.ttl = static_cast<std::uint8_t>(ttl);
        read.dscp = static_cast<std::uint8_t>(dscp);
        udp = read;
    }
}

} // namespace gridspace::streams
