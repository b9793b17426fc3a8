// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/addresses.hpp"

#include "bus/lockstep/foreign_frames.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <net/if.h>

namespace gridspace::launcher {
namespace {

std::string dotted(std::uint32_t a) {
    return fmt::format("{}.{}.{}.{}", a >> 24, (a >> 16) & 255, (a >> 8) & 255, a & 255);
}

/// The prefix of all runs, link, host.
std::string mac_of(std::size_t link, std::size_t host) {
    constexpr auto kPrefix = lockstep::kRunAddressPrefix;
    return fmt::format("{:02x}:{:02x}:{:02x}:{:02x}:{:02x}:{:02x}", kPrefix >> 16U, (kPrefix >> 8U) & 255U,
                       kPrefix & 255U, link & 255, (host >> 8) & 255, host & 255);
}

} // namespace

bool Subnet::overlaps(Subnet const& other) const {
    int const common = std::min(prefix, other.prefix);
    std::uint32_t const mask = common == 0 ? 0 : ~0U << (32 - common);
    return (base & mask) == (other.base & mask);
}

std::string Subnet::host(std::uint32_t number) const {
    return dotted(base + number);
}

std::optional<Subnet> parse_subnet(std::string_view text) {
    std::size_t const slash = text.find('/');
    if (slash == std::string_view::npos) {
        return std::nullopt;
    }
    auto const number = [](std::string_view digits, int max) -> std::optional<int> {
        int value = 0;
        auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc{} && end == digits.data() + digits.size() && value >= 0 && value <= max
                   ? std::optional{value}
                   : std::nullopt;
    };
    std::vector<std::string> const octets = split(text.substr(0, slash), '.');
    auto const prefix = number(text.substr(slash + 1), 32);
    if (octets.size() != 4 || !prefix) {
        return std::nullopt;
    }
    Subnet out;
    out.prefix = *prefix;
    for (std::string const& octet : octets) {
        auto const value = number(octet, 255);
        if (!value) {
            return std::nullopt;
        }
        out.base = out.base << 8U | static_cast<std::uint32_t>(*value);
    }
    std::uint32_t const mask = out.prefix == 0 ? 0 : ~0U << (32 - out.prefix);
    return (out.base & ~mask) == 0 ? std::optional{out} : std::nullopt;
}

Subnet management_subnet() {
    return {0x0AFE0000U, 16};
} // 10.254.0.0/16

std::vector<Port> plan_ports(Scenario const& scenario) {
    std::vector<Port> ports;
    Subnet const management = management_subnet();
    for (std::size_t h = 0; h < scenario.hosts.size(); ++h) {
        ports.push_back({scenario.hosts[h].name.name, std::string{kManagementLink}, std::string{kManagementLink},
                         mac_of(0, h + 1), management.host(static_cast<std::uint32_t>(h) + 1), management.prefix});
    }
    auto const plug = [](Host const& host, std::string_view link) {
        auto const it =
            std::find_if(host.plugs.begin(), host.plugs.end(), [&](auto const& p) { return p.first.name == link; });
        return it == host.plugs.end() ? std::string{} : it->second;
    };
    for (std::size_t h = 0; h < scenario.hosts.size(); ++h) {
        ports[h].plug = plug(scenario.hosts[h], kManagementLink);
    }
    for (std::size_t l = 0; l < scenario.links.size(); ++l) {
        Link const& link = scenario.links[l];
        auto const subnet = parse_subnet(link.ipv4);
        std::uint32_t next = 1;
        for (std::size_t h = 0; h < scenario.hosts.size(); ++h) {
            Host const& host = scenario.hosts[h];
            if (std::none_of(host.links.begin(), host.links.end(), [&](Ref const& r) { return r == link.name; })) {
                continue;
            }
            Port port{host.name.name,
                      link.name.name,
                      link.name.name.substr(0, IFNAMSIZ - 1),
                      mac_of(l + 1, h + 1),
                      "",
                      0,
                      plug(host, link.name.name)};
            if (subnet) {
                port.address = subnet->host(next++);
                port.prefix = subnet->prefix;
            }
            ports.push_back(std::move(port));
        }
    }
    return ports;
}

void check_addresses(Scenario const& scenario, config::Diagnostics& diagnostics) {
    std::vector<std::pair<Subnet, std::string>> seen{{management_subnet(), "the management network"}};
    for (Link const& link : scenario.links) {
        config::Node const* node = scenario.resolved.find("links");
        config::Node const* entry = node == nullptr ? nullptr : node->find(link.name.name);
        config::Node const* written = entry == nullptr ? nullptr : entry->find("ipv4");
        config::SourceMark const where = written == nullptr ? link.name.where : written->where;
        int const width = static_cast<int>(link.ipv4.size());
        if (link.name.name.size() >= IFNAMSIZ) {
            diagnostics.error(link.name.where,
                              fmt::format("the name of link '{}' is too long for a network interface", link.name.name),
                              fmt::format("at most {} characters", IFNAMSIZ - 1),
                              static_cast<int>(link.name.name.size()));
        }
        if (link.ipv4.empty()) {
            continue;
        }
        auto const subnet = parse_subnet(link.ipv4);
        if (!subnet) {
            diagnostics.error(where, fmt::format("'{}' is not an IPv4 network", link.ipv4), "for example 10.10.0.0/24",
                              width);
            continue;
        }
        for (auto const& [other, name] : seen) {
            if (subnet->overlaps(other)) {
                diagnostics.error(where,
                                  fmt::format("the addresses of link '{}' are also those of {}", link.name.name, name),
                                  "", width);
            }
        }
        seen.emplace_back(*subnet, "link '" + link.name.name + "'");
        auto const members = static_cast<std::uint32_t>(
            std::count_if(scenario.hosts.begin(), scenario.hosts.end(), [&](Host const& host) {
                return std::any_of(host.links.begin(), host.links.end(), [&](Ref const& r) { return r == link.name; });
            }));
        if (members > subnet->hosts()) {
            diagnostics.error(where,
                              fmt::format("link '{}' has {} hosts, and {} has room for {}", link.name.name, members,
                                          link.ipv4, subnet->hosts()),
                              "", width);
        }
    }
}

} // namespace gridspace::launcher
