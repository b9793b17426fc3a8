// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// An exported network in this process: by our importer, and by calls that no importer makes.
#include "launcher/fmu/grid_fmu.hpp"
#include "read_network_text.hpp"
#include "sim/solvers/make_engine.hpp"
#include "tests/unit/fmi/fmu_under_test.hpp"

#include "fmi/functions3.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

namespace gridspace::launcher {
namespace {

constexpr std::string_view kGrid = R"(gridspace_network: 1
name: exported grid
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}
sources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}
lines: {L: {from: A, to: B, r_ohm: 0.1, l_mh: 0.5}}
breaker_types: {quick: {mechanism_ms: 2}}
breakers: {CB: {line: L, end: from, type: quick}}
loads: {R: {bus: B, p_kw: 16, q_kvar: 2, model: constant_impedance}}
batteries: {BAT: {bus: B, capacity_kwh: 10, rating_kva: 10, p_kw: 1}}
)";

/// In waveforms, steps of 1/4800 s.
GridToExport grid_to_export() {
    GridToExport grid;
    grid.name = "exported grid";
    grid.engine.solver = sim::SolverKind::emt;
    grid.engine.step_s = Rational{1, 4800};
    grid.files = {{"network.yaml", std::string{kGrid}}};
    sim::Network const network = sim::network_of(kGrid);
    grid.inputs = sim::grid_inputs(network, true);
    grid.outputs = (*sim::make_engine(grid.engine, network, TimeBase{grid.engine.step_s}))->signals();
    std::ifstream in{build_tree("lib/gridspace_grid.so"), std::ios::binary};
    grid.binary = {std::istreambuf_iterator<char>{in}, {}};
    EXPECT_FALSE(grid.binary.empty()) << "the target gridspace_grid makes it";
    return grid;
}

struct ExportedFmu {
    ExportedFmu() {
        auto const octets = make_grid_fmu(grid_to_export());
        EXPECT_TRUE(octets) << octets.error().message;
        std::ofstream{file, std::ios::binary} << *octets;
    }
    TemporaryFolder folder;
    std::filesystem::path file{folder.path() / "grid.fmu"};
};

TEST(AnExportedFmu, IsSteppedBySetPointsAndCommandsThroughOurImporter) {
    ExportedFmu const exported;
    fmi::FmuUnderTest sut{exported.file};
    EXPECT_EQ(sut.description.co_simulation->identifier, "exported_grid");
    sut.begin();
    double const before = sut.number("bus.B.v_pu");

    sut.set("set_point.load.R.p_kw", 1.0);
    auto const outcome = sut.instance->do_step(0, 0.25, false);
    ASSERT_TRUE(outcome) << outcome.error().message;

    EXPECT_EQ(outcome->reached_s, 0.25);
    EXPECT_GT(sut.number("bus.B.v_pu"), before);
    sut.set("command.breaker.CB.closed", false);
    ASSERT_TRUE(sut.instance->do_step(0.25, 0.25, false));
    EXPECT_EQ(sut.number("breaker.CB.position"), 1);
    EXPECT_LT(sut.number("bus.B.v_pu"), 0.01);
}

TEST(AnExportedFmu, WhoseStepIsRefusedSaysWhyThroughOurImporter) {
    ExportedFmu const exported;
    fmi::FmuUnderTest sut{exported.file};
    sut.begin();

    auto const outcome = sut.instance->do_step(0, 1e-5, false);

    ASSERT_FALSE(outcome);
    EXPECT_NE(outcome.error().message.find("no whole number of steps of 1/4800 s"), std::string::npos)
        << outcome.error().message;
}

/// What nobody should ask for gives fmi3Error and a message, and never a crash: any function, in any order, with any
/// number.
TEST(AnExportedFmu, SurvivesCallsInAnyOrder) {
    ExportedFmu const exported;
    auto const archive = fmi::Archive::open(exported.file);
    ASSERT_TRUE(archive);
    auto const description = fmi::read_model_description(*archive, "grid.fmu");
    TemporaryFolder const folder;
    ASSERT_TRUE(archive->unpack(folder.path()));
    fmi::NotingHost host;
    auto object = fmi::SharedObject::load(folder.path() / *fmi::binary_of(*archive, *description), "grid.fmu", host);
    ASSERT_TRUE(object) << object.error().message;
    fmi::CoSimulation all_functions;
    all_functions.can_get_and_set_state = all_functions.can_serialize_state = true;
    fmi::v3::Functions const f = fmi::v3::find_functions(*object, all_functions);
    std::string const resources = (folder.path() / "resources").string() + "/";
    int messages = 0;
    fmi::v3::LogMessage* const log = [](void* count, int, char const*, char const*) { ++*static_cast<int*>(count); };
    std::mt19937 random{7}; // NOLINT(cert-msc32-c,cert-msc51-cpp): the same calls each time
    auto const any = [&](auto const& values) { return values[random() % values.size()]; };
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    std::array const numbers{0.0, 1.0, -1.0, 0.25, 1e300, -1e300, 1.0 / 4800, kNan};
    auto const last = static_cast<std::uint32_t>(description->variables.size());
    std::array const references{0U, 1U, 2U, 3U, last / 2, last - 1, last, 0xFFFFFFFFU};
    int errors = 0, done = 0;

    for (int round = 0; round < 20; ++round) {
        void* const sut = f.instantiate("sut", description->token.c_str(), resources.c_str(), false, false, false,
                                        false, nullptr, 0, &messages, log, nullptr);
        ASSERT_NE(sut, nullptr);
        for (int call = 0; call < 60; ++call) {
            std::uint32_t const reference = any(references);
            double number = any(numbers), reached = 0;
            bool yes = number > 0, a = false, b = false, c = false;
            void* state = nullptr;
            int const before = messages;
            int status = 0;
            switch (random() % 10) {
            case 0:
                status = f.enter_initialization_mode(sut, false, 0, round % 4 == 0 ? number : 0, false, 0);
                break;
            case 1:
                status = f.exit_initialization_mode(sut);
                break;
            case 2:
                status = f.set_float64(sut, &reference, 1, &number, call % 7 == 0 ? 0 : 1);
                break;
            case 3:
                status = f.set_boolean(sut, &reference, 1, &yes, 1);
                break;
            case 4:
                status = f.get_float64(sut, &reference, 1, &number, 1);
                break;
            case 5:
                status = f.get_boolean(sut, &reference, 1, &yes, 1);
                break;
            case 6:
                status = f.get_state(sut, &state);
                break;
            case 7:
                status = call % 20 == 0 ? f.terminate(sut) : 0;
                break;
            default:
                status = f.do_step(sut, done == 0 ? 0 : number, 1.0 / 4800, false, &a, &b, &c, &reached);
            }
            EXPECT_TRUE(status == 0 || status == 3) << status;
            EXPECT_EQ(messages - before, status == 3 ? 1 : 0) << "each error has its message";
            (status == 3 ? errors : done) += 1;
        }
        f.free_instance(sut);
    }
    EXPECT_GT(errors, 100);
    EXPECT_GT(done, 100);
}

} // namespace
} // namespace gridspace::launcher
