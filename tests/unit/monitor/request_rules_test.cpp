// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/request_rules.hpp"

#include <gmock/gmock.h>

namespace gridspace::web {
namespace {

TEST(RequestTarget, IsTakenApartAndDecodedOnce) {
    auto const target = parse_target("/api/v1/signals/query?names=bus.B1.v_pu%2Cbus.B2.v_pu&t0=0&note=a+b");
    ASSERT_TRUE(target.has_value());
    EXPECT_EQ(target->path, "/api/v1/signals/query");
    EXPECT_EQ(target->query.at("names"), "bus.B1.v_pu,bus.B2.v_pu");
    EXPECT_EQ(target->query.at("note"), "a b");
    EXPECT_EQ(parse_target("/a%252e")->path, "/a%2e"); // not twice
}

TEST(RequestTarget, MayEndInASlashAndMayHaveNoQuery) {
    EXPECT_EQ(parse_target("/")->path, "/");
    EXPECT_EQ(parse_target("/a/")->path, "/a/");
    EXPECT_TRUE(parse_target("/a?")->query.empty());
}

class BadTarget : public testing::TestWithParam<std::string> {};

TEST_P(BadTarget, IsRefused) {
    EXPECT_FALSE(parse_target(GetParam()).has_value()) << GetParam();
}

INSTANTIATE_TEST_SUITE_P(RequestTarget, BadTarget,
                         testing::Values("", "x", "http://evil/", "/../etc/passwd", "/a/..", "/a/../b", "/%2e%2e/x",
                                         "/%2E%2e%2Fx", "/./x", "//x", "/a//b", "/a\\b", "/a%5Cb", "/a%00b",
                                         "/a%0d%0ab", "/a%", "/a%2", "/a%zz", "/a?x=%zz", "/a?x=%00",
                                         "/" + std::string(5000, 'a')));

TEST(HostHeader, MayNameThisMachineWithAnyPortAndNothingElse) {
    Sites const sites;
    for (char const* good : {"127.0.0.1", "127.0.0.1:8080", "localhost:1", "LocalHost:65535", "[::1]:80", "[::1]"}) {
        EXPECT_TRUE(host_allowed(sites, good)) << good;
    }
    for (char const* bad : {"", "evil.example", "localhost.evil.example", "127.0.0.1.evil:80",
                            "localhost:", "localhost:8x", "localhost:123456"}) {
        EXPECT_FALSE(host_allowed(sites, bad)) << bad;
    }
}

TEST(OriginHeader, MayBeMissingOrOneOfOurs) {
    Sites sites;
    sites.hosts.emplace_back("grid.lab");
    for (char const* good : {"", "http://localhost:99", "https://127.0.0.1", "http://grid.lab:8080"}) {
        EXPECT_TRUE(origin_allowed(sites, good)) << good;
    }
    for (char const* bad : {"null", "http://evil.example", "file://", "localhost", "http://localhost.evil"}) {
        EXPECT_FALSE(origin_allowed(sites, bad)) << bad;
    }
}

TEST(Secrets, AreTheSameOnlyWhenEveryCharacterIs) {
    EXPECT_TRUE(same_secret("abc", "abc"));
    EXPECT_FALSE(same_secret("abc", "abd"));
    EXPECT_FALSE(same_secret("abc", "abcd"));
    EXPECT_FALSE(same_secret("abcabc", "abc"));
    EXPECT_FALSE(same_secret("", "x"));
}

} // namespace
} // namespace gridspace::web
