// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/compare/compare.hpp"
#include "recorder/mcap/mcap_writer.hpp"
#include "tests/support/cdr_sample.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

class CompareSignals : public ::testing::Test {
  protected:
    /// A recording of the signals x.A and x.B, a row every 10 ns.
    [[nodiscard]] std::filesystem::path recording(std::string const& name,
                                                  std::vector<std::array<double, 2>> const& rows) const {
        auto file = mcap::Writer::create(folder_ / name, {});
        EXPECT_TRUE(file);
        auto const schema = file->add_schema("T", "omgidl", "struct T { long a; };");
        auto const catalog = file->add_channel(schema, "signal_catalog", "cdr", {}),
                   frames = file->add_channel(schema, "signals", "cdr", {});
        CdrSample columns;
        columns.text("sim");
        columns.text("g");
        columns.number(0.0);
        columns.number(std::uint32_t{2});
        for (char const* signal : {"x.A", "x.B"}) {
            columns.text(signal);
            columns.text("");
        }
        EXPECT_TRUE(file->write(catalog, 1, 0, columns.octets()));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            CdrSample row;
            row.text("sim");
            row.text("g");
            row.number(std::uint32_t{1});
            row.number(static_cast<std::int64_t>(10 * i));
            row.number(std::uint32_t{2});
            row.number(rows[i][0]);
            row.number(rows[i][1]);
            EXPECT_TRUE(file->write(frames, static_cast<std::uint32_t>(i + 1), 10 * i, row.octets()));
        }
        EXPECT_TRUE(file->close());
        return folder_ / name;
    }
    [[nodiscard]] std::vector<std::pair<std::uint64_t, std::string>>
    differences(std::vector<std::array<double, 2>> const& a, std::vector<std::array<double, 2>> const& b) const {
        CompareOptions options;
        options.signals = {"x.*"};
        auto const sut = compare_recordings(recording("a", a), recording("b", b), options);
        EXPECT_TRUE(sut) << describe(sut.error());
        std::vector<std::pair<std::uint64_t, std::string>> out;
        for (Difference const& d : sut ? sut->differences : std::vector<Difference>{}) {
            out.emplace_back(d.time_ns, d.topic);
        }
        return out;
    }

    TemporaryFolder temporary_;
    std::filesystem::path folder_{temporary_.path()};
};

using Differences = std::vector<std::pair<std::uint64_t, std::string>>;

TEST_F(CompareSignals, TheEarliestDivergenceIsSaidFirstWhateverItsName) {
    EXPECT_EQ(differences({{1, 1}, {2, 2}, {3, 3}}, {{1, 1}, {2, 9}, {9, 9}}), (Differences{{10, "x.B"}, {20, "x.A"}}));
}

TEST_F(CompareSignals, DivergencesOfOneInstantAreInTheOrderOfTheirNames) {
    EXPECT_EQ(differences({{1, 1}, {2, 2}}, {{1, 1}, {9, 9}}), (Differences{{10, "x.A"}, {10, "x.B"}}));
}

TEST_F(CompareSignals, ARecordingThatEndsEarlierDivergesWhereTheOtherGoesOn) {
    EXPECT_EQ(differences({{1, 1}, {2, 2}, {3, 3}}, {{1, 1}, {2, 9}}), (Differences{{10, "x.B"}, {20, "x.A"}}));
    EXPECT_EQ(differences({{1, 1}}, {{1, 1}}), Differences{});
}

} // namespace
} // namespace gridspace
