// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "router/route_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::router {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Reads a router's configuration; `said` gets what is wrong with it.
RouterConfig read(std::string const& text, std::string& said) {
    config::Diagnostics diagnostics;
    RouterConfig out;
    auto const root = config::parse_yaml(text, config::make_source("r.yaml", text), diagnostics);
    if (root) {
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, out); });
    }
    said = diagnostics.ok() ? "" : diagnostics.render();
    return out;
}
RouterConfig valid(std::string const& text) {
    std::string said;
    RouterConfig out = read(text, said);
    EXPECT_EQ(said, "");
    return out;
}

constexpr char const* kTwoDomainsAndALink =
    "router: r\n"
    "ends: {a: {domain: 1}, b: {domain: 2}, wan: {connect: '192.0.2.7:7411'}, far: {listen: 7412, tls: {certificate: "
    "c, private_key: k, authority: a}}}\n"
    "topics: {x: {}, one_way: {from: [a], to: [b]}}\n";
enum : std::size_t { a, b, wan, far };

bus::DiscoveredEndpoint writer(std::string id, std::string participant, std::string topic) {
    bus::DiscoveredEndpoint out;
    out.id = std::move(id);
    out.participant = std::move(participant);
    out.topic = std::move(topic);
    out.type = "T";
    out.writer = true;
    out.qos.reliable = true;
    out.qos.durability = bus::Durability::transient_local;
    return out;
}

TEST(RouteTable, CarriesWhatTheAllowListNamesAndNothingElse) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "gridspace-ev");
    sut.endpoint_found(a, writer("w1", "p", "x"));
    sut.endpoint_found(a, writer("w2", "p", "secret"));
    auto const routes = sut.routes();
    ASSERT_EQ(routes.size(), 1U);
    EXPECT_EQ(routes[0].topic, "x");
    EXPECT_EQ(routes[0].from, std::size_t{a});
    EXPECT_THAT(routes[0].to, ElementsAre(b, wan, far));
}

TEST(RouteTable, ADirectionIsKept) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "");
    sut.participant_found(b, "q", "");
    sut.endpoint_found(b, writer("w1", "q", "one_way"));
    EXPECT_THAT(sut.routes(), IsEmpty());
    sut.endpoint_found(a, writer("w2", "p", "one_way"));
    ASSERT_EQ(sut.routes().size(), 1U);
    EXPECT_THAT(sut.routes()[0].to, ElementsAre(b));
}

TEST(RouteTable, WhatARouterWroteIntoADomainIsNotTakenUpAgain) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "other", "gridspace-router");
    sut.endpoint_found(a, writer("w1", "other", "x"));
    sut.endpoint_found(a, writer("w2", "this router itself", "x")); // its own participant is never announced
    EXPECT_THAT(sut.routes(), IsEmpty());
    EXPECT_FALSE(sut.takes(a, "gridspace-router"));
    EXPECT_TRUE(sut.takes(a, "gridspace-ev"));
    auto const notes = sut.take_notes();
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_THAT(notes[0], HasSubstr("another router"));
    sut.endpoint_found(a, writer("w3", "other", "x"));
    EXPECT_THAT(sut.take_notes(), IsEmpty()); // said once
}

TEST(RouteTable, OnALinkRoutersAreHeardAndNothingGoesFromLinkToLink) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(wan, "other", "gridspace-router");
    sut.endpoint_found(wan, writer("w1", "other", "x"));
    auto const routes = sut.routes();
    ASSERT_EQ(routes.size(), 1U);
    EXPECT_EQ(routes[0].from, std::size_t{wan});
    EXPECT_THAT(routes[0].to, ElementsAre(a, b));
}

TEST(RouteTable, ItsQosAreWhatAllWritersOffer) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "");
    auto first = writer("w1", "p", "x"), second = writer("w2", "p", "x");
    first.qos.deadline_s = 0.1;
    sut.endpoint_found(a, first);
    EXPECT_TRUE(sut.routes()[0].qos.reliable);
    EXPECT_EQ(sut.routes()[0].qos.durability, bus::Durability::transient_local);
    EXPECT_EQ(sut.routes()[0].qos.deadline_s, 0.1);
    second.qos.reliable = false;
    second.qos.durability = bus::Durability::volatile_;
    second.qos.deadline_s = 0.5;
    sut.endpoint_found(a, second);
    ASSERT_EQ(sut.routes().size(), 1U);
    EXPECT_FALSE(sut.routes()[0].qos.reliable);
    EXPECT_EQ(sut.routes()[0].qos.durability, bus::Durability::volatile_);
    EXPECT_EQ(sut.routes()[0].qos.deadline_s, 0.5);
    sut.endpoint_gone("w2");
    EXPECT_TRUE(sut.routes()[0].qos.reliable);
}

TEST(RouteTable, ARouteEndsWithItsLastWriter) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "");
    sut.endpoint_found(a, writer("w1", "p", "x"));
    sut.endpoint_found(a, writer("w2", "p", "x"));
    sut.endpoint_gone("w1");
    EXPECT_EQ(sut.routes().size(), 1U);
    sut.participant_gone("p");
    EXPECT_THAT(sut.routes(), IsEmpty());
}

TEST(RouteTable, WhatItCannotCarryIsSaid) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "");
    auto exclusive = writer("w1", "p", "x"), hidden = writer("w2", "p", "x");
    exclusive.qos.exclusive = true;
    hidden.qos.partitions = {"room"};
    sut.endpoint_found(a, exclusive);
    sut.endpoint_found(a, hidden);
    EXPECT_THAT(sut.routes(), IsEmpty());
    EXPECT_THAT(sut.take_notes(), ElementsAre(HasSubstr("exclusive"), HasSubstr("room")));
}

TEST(RouteTable, AWriterThatNoReaderOfTheRouterUnderstandsIsNotCarriedAndTheReasonIsSaid) {
    RouterConfig const config = valid(kTwoDomainsAndALink);
    RouteTable sut{config};
    sut.participant_found(a, "p", "");
    auto newer = writer("w1", "p", "x"), both = writer("w2", "p", "x"), hidden = writer("w3", "p", "x");
    newer.qos.representations = {bus::Representation::xcdr2};
    both.qos.representations = {bus::Representation::xcdr2, bus::Representation::xcdr1}; // it uses the first
    hidden.qos.partitions = {"room", "hall"};
    for (auto const& found : {newer, both, hidden}) {
        sut.endpoint_found(a, found);
    }
    EXPECT_THAT(sut.routes(), IsEmpty());
    EXPECT_THAT(sut.take_notes(), ElementsAre("a writer of 'x' on a is not heard: it writes XCDR2",
                                              "a writer of 'x' on a is not heard: it is in the partitions room, hall"));
    auto moving = writer("w4", "p", "x");
    sut.endpoint_found(a, moving);
    ASSERT_EQ(sut.routes().size(), 1U);
    moving.qos.partitions = {"room"};
    sut.endpoint_found(a, moving);
    EXPECT_THAT(sut.routes(), IsEmpty());
}

struct Mistake {
    char const* name;
    char const* text;
    char const* said;
};
class RouterConfigMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(RouterConfigMistakes, AreSaidWithTheirPlace) {
    std::string said;
    (void)read(GetParam().text, said);
    EXPECT_THAT(said, HasSubstr(GetParam().said));
    EXPECT_THAT(said, HasSubstr("r.yaml:"));
}
INSTANTIATE_TEST_SUITE_P(
    , RouterConfigMistakes,
    testing::Values(
        Mistake{"no_name", "ends: {a: {}, b: {domain: 1}}\ntopics: {x: {}}\n", "router"},
        Mistake{"one_end", "router: r\nends: {a: {}}\ntopics: {x: {}}\n", "two ends"},
        Mistake{"unknown_end", "router: r\nends: {a: {}, b: {domain: 1}}\ntopics: {x: {from: [c]}}\n",
                "there is no end 'c'"},
        Mistake{"unknown_key", "router: r\nends: {a: {domian: 3}, b: {}}\ntopics: {x: {}}\n", "did you mean 'domain'"},
        Mistake{"bad_port", "router: r\nends: {a: {}, b: {connect: 'x:0'}}\ntopics: {x: {}}\n", "is not ADDRESS:PORT"},
        Mistake{"port_too_large", "router: r\nends: {a: {}, b: {listen: 70000}}\ntopics: {x: {}}\n", "65535"},
        Mistake{"both", "router: r\nends: {a: {}, b: {listen: 1, connect: '1.2.3.4:1'}}\ntopics: {x: {}}\n",
                "either listens or connects"},
        Mistake{"open_to_all", "router: r\nends: {a: {}, b: {listen: 7411}}\ntopics: {x: {}}\n",
                "whoever reaches port 7411 of this machine could take part: that needs TLS"},
        Mistake{"tls_without_link",
                "router: r\nends: {a: {}, b: {tls: {certificate: c, private_key: k, authority: a}}}\ntopics: {x: {}}\n",
                "only a link has TLS"},
        Mistake{"tls_without_key",
                "router: r\nends: {a: {}, b: {listen: 1, tls: {certificate: c, authority: a}}}\ntopics: {x: {}}\n",
                "private_key"},
        Mistake{"back_to_itself", "router: r\nends: {a: {}, b: {domain: 1}}\ntopics: {x: {from: [a], to: [a]}}\n",
                "not carried to where it comes from"},
        Mistake{"catalog", "router: r\nends: {a: {}, b: {domain: 1}}\ntopics: {type_catalog: {}}\n",
                "carried by itself"},
        Mistake{"run_and_domain", "router: r\nends: {a: {run: data, domain: 3}, b: {}}\ntopics: {x: {}}\n",
                "the run says the domain"},
        Mistake{"same_domain_twice", "router: r\nends: {a: {}, b: {}}\ntopics: {x: {}}\n", "the same domain"}),
    [](auto const& mistake) { return mistake.param.name; });

TEST(RouterConfig, TakesTheNetworksOfTheRunThatHasStartedIt) {
    RouterConfig sut = valid("router: r\nends: {m: {run: management}, d: {run: data}, w: {listen: 1, tls: "
                             "{certificate: c, private_key: k, authority: a}}}\ntopics: {x: {}}\n");
    EXPECT_FALSE(take_run_networks(sut, [](char const*) { return nullptr; }).has_value());
    ASSERT_TRUE(
        take_run_networks(sut, [](std::string const& name) {
            return name == "GRIDSPACE_MANAGEMENT_DOMAIN" ? "40" : name == "GRIDSPACE_DATA_DOMAIN" ? "41" : "127.0.0.1";
        }).has_value());
    EXPECT_EQ(sut.ends[0].domain, 40);
    EXPECT_EQ(sut.ends[1].domain, 41);
    EXPECT_THAT(sut.ends[1].addresses, ElementsAre("127.0.0.1"));
    EXPECT_THAT(sut.ends[2].addresses, IsEmpty());
}

} // namespace
} // namespace gridspace::router
