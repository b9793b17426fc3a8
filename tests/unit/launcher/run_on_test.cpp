// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/run_on.hpp"

#include "common/source_tree.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

TEST(RunOn, OfABoardNamesUserHostAndPort) {
    auto const sut = parse_run_on("ssh:pi@board-1.local:2222");

    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->kind, RunOn::Kind::ssh);
    EXPECT_EQ(sut->user, "pi");
    EXPECT_EQ(sut->host, "board-1.local");
    EXPECT_EQ(sut->port, 2222);
    EXPECT_EQ(sut->place(), "pi@board-1.local:2222");
    EXPECT_FALSE(sut->is_emulated());
}

TEST(RunOn, LeavesUserAndPortToTheConfigurationOfSsh) {
    auto const sut = parse_run_on("ssh:board1");

    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->user, "");
    EXPECT_EQ(sut->port, 0);
    EXPECT_EQ(sut->place(), "board1");
}

TEST(RunOn, TakesAnIPv6AddressInBrackets) {
    auto const sut = parse_run_on("ssh:root@[fe80::1]:22");

    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->host, "fe80::1");
    EXPECT_EQ(sut->place(), "root@[fe80::1]:22");
}

TEST(RunOn, RefusesWhatSshOrAShellCouldTakeForSomethingElse) {
    for (char const* wrong : {"ssh:", "ssh:@host", "ssh:user@", "ssh:-oProxyCommand=x", "ssh:user@-h",
                              "ssh:host;reboot", "ssh:$(x)", "ssh:a b", "ssh:host:", "ssh:host:0", "ssh:host:65536",
                              "ssh:host:22x", "ssh:[fe80::1", "ssh:[::1]x22", "ssh:[host]", "ssh", "qemu"}) {
        EXPECT_FALSE(parse_run_on(wrong)) << wrong;
    }
}

TEST(RunOn, IsWarnedOfWhenAnEmulatedProcessWouldHandOnFrames) {
    auto const said_with = [](char const* place) {
        config::Diagnostics diagnostics;
        LoadOptions options;
        options.set = {std::string{"defaults.gridspace-attacker.run_on="} + place};
        (void)load_scenario(source_tree("configs/scenarios/fdi_ids_arm64.yaml"), options, diagnostics);
        EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        return diagnostics.render();
    };
    EXPECT_NE(said_with("qemu-user").find("lose their VLAN tag"), std::string::npos);
    EXPECT_EQ(said_with("native").find("lose their VLAN tag"), std::string::npos);
}

} // namespace
} // namespace gridspace::launcher
