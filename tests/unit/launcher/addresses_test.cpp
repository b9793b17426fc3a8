// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gtest/gtest.h>
#include <set>

namespace gridspace::launcher {
namespace {

TEST(Subnet, IsReadStrictly) {
    auto const sut = parse_subnet("10.10.0.0/24");
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->hosts(), 254U);
    EXPECT_EQ(sut->host(1), "10.10.0.1");
    EXPECT_EQ(parse_subnet("192.168.4.0/22")->host(256), "192.168.5.0");
    for (char const* text : {"", "10.10.0.0", "10.10.0/24", "10.10.0.0/33", "10.10.0.256/24", "10.10.0.0/-1",
                             "a.b.c.d/8", "10.10.0.0/24x", "10.10.0.0/"}) {
        EXPECT_FALSE(parse_subnet(text)) << text;
    }
}

TEST(Subnet, KnowsWhomItOverlaps) {
    EXPECT_TRUE(parse_subnet("10.0.0.0/8")->overlaps(*parse_subnet("10.10.0.0/24")));
    EXPECT_TRUE(parse_subnet("10.10.0.0/24")->overlaps(*parse_subnet("10.0.0.0/8")));
    EXPECT_FALSE(parse_subnet("10.10.0.0/24")->overlaps(*parse_subnet("10.10.1.0/24")));
}

Scenario scenario() {
    Scenario s;
    for (char const* name : {"a", "b", "c"}) {
        Host host;
        host.name = {name, {}};
        host.links = {{"lan", {}}, {"wire", {}}};
        s.hosts.push_back(host);
    }
    for (auto const& [name, network] : {std::pair{"lan", "10.10.0.0/24"}, {"wire", "none"}}) {
        Link link;
        link.name = {name, {}};
        link.ipv4 = network;
        s.links.push_back(link);
    }
    return s;
}

TEST(Ports, AreTheSameInEveryRunAndNeverShareAnAddress) {
    std::vector<Port> const sut = plan_ports(scenario()), again = plan_ports(scenario());
    ASSERT_EQ(sut.size(), 9U); // each host: management, lan, wire
    std::set<std::string> macs, addresses;
    for (std::size_t i = 0; i < sut.size(); ++i) {
        EXPECT_EQ(sut[i].mac, again[i].mac);
        EXPECT_EQ(sut[i].address, again[i].address);
        EXPECT_EQ(std::stoi(sut[i].mac.substr(0, 2), nullptr, 16) & 3, 2) << "locally administered, one receiver";
        EXPECT_TRUE(macs.insert(sut[i].mac).second) << sut[i].mac;
        if (!sut[i].address.empty()) {
            EXPECT_TRUE(addresses.insert(sut[i].address).second) << sut[i].address;
        }
        EXPECT_EQ(sut[i].address.empty(), sut[i].link == "wire");
        EXPECT_LE(sut[i].interface.size(), 15U) << "what Linux allows";
    }
}

} // namespace
} // namespace gridspace::launcher
