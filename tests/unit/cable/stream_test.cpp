// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/stream.hpp"
#include "gateways/cable/tap.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace gridspace::cable {
namespace {

struct Taken {
    Kind kind;
    int port;
    std::string bytes;
    bool operator==(Taken const&) const = default;
};

std::vector<Taken> all(Stream& sut) {
    std::vector<Taken> out;
    while (auto const message = sut.next()) {
        out.push_back({message->kind, message->port, std::string{message->bytes}});
    }
    return out;
}

TEST(CableStream, GivesBackEveryMessageHoweverTheStreamWasCut) {
    std::vector<Taken> const sent{{Kind::frame, 2, std::string(1514, '\xff')},
                                  {Kind::alive, 0, ""},
                                  {Kind::file, 0, std::string{"config.yaml\0a: 1\n", 17}},
                                  {Kind::go, 0, ""}};
    std::string octets;
    for (Taken const& message : sent) {
        append(octets, message.kind, static_cast<std::uint8_t>(message.port), message.bytes);
    }
    for (std::size_t piece : {std::size_t{1}, std::size_t{5}, std::size_t{7}, std::size_t{1000}, octets.size()}) {
        Stream sut;
        std::vector<Taken> taken;
        for (std::size_t at = 0; at < octets.size(); at += piece) {
            sut.feed(std::string_view{octets}.substr(at, piece));
            for (Taken& message : all(sut)) {
                taken.push_back(std::move(message));
            }
        }
        EXPECT_EQ(taken, sent) << "in pieces of " << piece;
        EXPECT_FALSE(sut.broken());
    }
}

TEST(CableStream, IsBrokenByALengthThatNobodySends) {
    Stream sut;
    sut.feed(std::string_view{"d\0\xff\xff\xff\xff....", 10});

    EXPECT_FALSE(sut.next());
    EXPECT_TRUE(sut.broken());
    std::string good;
    append(good, Kind::alive);
    sut.feed(good);
    EXPECT_FALSE(sut.next()) << "what follows cannot be trusted";
}

TEST(CablePort, IsNameMacAndAddress) {
    auto const port = parse_port("process_bus,02:47:53:02:00:04,-");

    ASSERT_TRUE(port);
    EXPECT_EQ(port->name, "process_bus");
    EXPECT_EQ(port->mac, "02:47:53:02:00:04");
    EXPECT_EQ(port->address, "-");
    for (char const* wrong : {"", "mgmt0", "mgmt0,02:47:53:02:00:04", ",02:47:53:02:00:04,-",
                              "a_name_that_is_too_long,02:47:53:02:00:04,-"}) {
        EXPECT_FALSE(parse_port(wrong)) << wrong;
    }
}

} // namespace
} // namespace gridspace::cable
