// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/wire_use.hpp"

#include "gateways/iec61850/frame.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

/// A device that sends the stream S on its network A.
struct Publisher final : ProcessSettings {
    [[nodiscard]] std::vector<WireUse> sends(Scenario const&, Process const&) const override {
        return {{"lan_a", iec61850::kSvEthertype, "S"}};
    }
    [[nodiscard]] config::Node settings(Scenario const&, Process const&) const override { return config::Node::map(); }
};

/// A stream whose frame has about `octets` octets behind the ethertype, by the length of its svID.
streams::Stream stream_of(std::size_t octets) {
    streams::Stream out;
    out.name.name = out.data_set_name = "S";
    out.sv_id = "S";
    out.address.vlan = iec61850::VlanTag{};
    for (int i = 0; i < 340; ++i) {
        out.data_set.members.push_back(iec61850::DataNode::leaf("v" + std::to_string(i), iec61850::BasicType::float32));
    }
    while (out.longest_payload() < octets) {
        out.sv_id += "x";
    }
    return out;
}

std::string said_about(std::size_t octets, bool doubly_attached) {
    Scenario s;
    s.streams.push_back(stream_of(octets));
    EXPECT_EQ(s.streams.front().longest_payload(), octets);
    Process process;
    process.name = {"mu", {}};
    process.settings = std::make_unique<Publisher>();
    if (doubly_attached) {
        process.prp = {{"lan_a", {}}, {"lan_b", {}}};
    }
    config::Diagnostics diagnostics;
    check_room_for_trailers(s, process, diagnostics);
    return diagnostics.errors() > 0 ? diagnostics.render() : "";
}

TEST(StreamsOfADoublyAttachedProcess, HaveRoomForTheTrailerOrAreRefused) {
    EXPECT_EQ(said_about(1494, true), "");
    for (std::size_t const octets : {1495U, 1500U}) {
        EXPECT_EQ(said_about(octets, false), "") << "without PRP the whole frame is its own";
        std::string const said = said_about(octets, true);
        EXPECT_NE(said.find("a frame of stream 'S' could have " + std::to_string(octets)), std::string::npos) << said;
        EXPECT_NE(said.find("there is room for 1494"), std::string::npos) << said;
        EXPECT_EQ(said.find("stream 'S'"), said.rfind("stream 'S'")) << "on both networks, and said once";
    }
}

} // namespace
} // namespace gridspace::launcher
