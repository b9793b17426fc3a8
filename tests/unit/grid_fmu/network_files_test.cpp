// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/fmu/network_files.hpp"

#include "launcher/fmu/grid_fmu.hpp"
#include "sim/network/network_config.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

void write_text(std::filesystem::path const& file, std::string_view text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream{file} << text;
}

TEST(NetworkFiles, AreWhatANetworkExtendsInOneFileAndEachProfileOnce) {
    TemporaryFolder const folder;
    write_text(folder.path() / "base/base.yaml", R"(gridspace_network: 1
name: base
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}}
generators: {G: {bus: A, role: slack}}
loads: {L: {bus: A, p_kw: 3, scale: day}}
profiles: {day: {csv: ../data/day.csv, column: home}, night: {csv: ../data/day.csv, column: other}}
)");
    write_text(folder.path() / "data/day.csv", "hours,home,other\n0,0.5,1\n24,1,2\n");
    write_text(folder.path() / "grid.yaml", "extends: base/base.yaml\nname: grid\nloads: {L: {p_kw: 0.1}}\n");
    config::Diagnostics diagnostics;
    auto const files = network_files(folder.path() / "grid.yaml", diagnostics);
    ASSERT_TRUE(files) << diagnostics.render();
    ASSERT_EQ(files->size(), 2U) << "the network, and one file of profiles";

    TemporaryFolder const elsewhere;
    for (fmi::ArchiveFile const& file : *files) {
        write_text(elsewhere.path() / file.name, file.content);
    }
    auto const network = sim::load_network(elsewhere.path() / files->front().name, diagnostics);

    ASSERT_TRUE(network) << diagnostics.render();
    EXPECT_EQ(network->name, "grid");
    EXPECT_EQ(network->loads.at(0).p_kw, 0.1);
    ASSERT_EQ(network->profiles.size(), 2U);
    EXPECT_EQ(network->profiles[0].values, (std::vector{0.5, 1.0}));
    EXPECT_EQ(network->profiles[1].values, (std::vector{1.0, 2.0}));
}

TEST(ModelIdentifier, IsAnIdentifierOfC) {
    EXPECT_EQ(model_identifier("house"), "house");
    EXPECT_EQ(model_identifier("IEEE 13-bus"), "IEEE_13_bus");
    EXPECT_EQ(model_identifier("9 buses"), "grid_9_buses");
    EXPECT_EQ(model_identifier(""), "grid_");
}

} // namespace
} // namespace gridspace::launcher
