// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The reference FMUs of the FMI project as an oracle, where somebody has them (docs/reference/fmi.md says how to get
// them): GRIDSPACE_REFERENCE_FMUS names a folder with fmi2/*.fmu and fmi3/*.fmu, GRIDSPACE_REFERENCE_RESULTS one with
// MODEL/MODEL_out.csv.
#include "common/text.hpp"
#include "fmi/stepper.hpp"
#include "tests/unit/fmi/fmu_under_test.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace gridspace::fmi {
namespace {

constexpr double kTolerance = 1e-9; // relative to the larger of the value and 1

struct Expected {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
};

Expected read_csv(std::filesystem::path const& file) {
    Expected out;
    std::ifstream in{file};
    for (std::string line; std::getline(in, line);) {
        auto row = split(trim(line), ',');
        out.columns.empty() ? void(out.columns = std::move(row)) : out.rows.push_back(std::move(row));
    }
    return out;
}

double number(std::string const& text) {
    double out = NAN;
    std::from_chars(text.data(), text.data() + text.size(), out);
    return out;
}

/// One of them, and what it shall give.
struct ReferenceFmu {
    ReferenceFmu(std::filesystem::path const& fmus, std::filesystem::path const& results, int version,
                 std::string const& model)
        : sut{fmus / fmt::format("fmi{}/{}.fmu", version, model)},
          expected{read_csv(results / model / (model + "_out.csv"))} {}

    /// Columns that are numbers and that the version of the FMU has.
    void compare(std::vector<std::string> const& row) {
        for (std::size_t i = 1; i < row.size(); ++i) {
            Variable const* variable = sut.description.find(expected.columns[i]);
            if (variable == nullptr || !is_number(variable->type)) {
                continue;
            }
            double const wanted = number(row[i]);
            double const got = std::visit(
                [](auto const& v) -> double {
                    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>) {
                        return static_cast<double>(v);
                    } else {
                        return NAN;
                    }
                },
                sut.get(variable->name));
            double const error = std::abs(got - wanted) / std::max(1.0, std::abs(wanted));
            worst = std::max(worst, error);
            ++compared;
            ASSERT_LE(error, kTolerance) << variable->name << " at " << row[0] << " s: " << got << ", not " << wanted;
        }
    }

    void run() {
        ASSERT_GT(expected.rows.size(), 1U);
        sut.begin(number(expected.rows.front()[0]));
        compare(expected.rows.front());
        bool terminated = false;
        for (std::size_t i = 1; i < expected.rows.size() && !::testing::Test::HasFatalFailure(); ++i) {
            ASSERT_FALSE(terminated) << "it ended before " << expected.rows[i][0] << " s";
            double const from_s = number(expected.rows[i - 1][0]), to_s = number(expected.rows[i][0]);
            auto const step = advance(*sut.instance, sut.can(), sut.description.file, from_s, to_s - from_s);
            ASSERT_TRUE(step) << step.error().message;
            terminated = step->terminated;
            compare(expected.rows[i]);
        }
        fmt::print("{} of FMI {}: {} values, worst relative error {:.2g}\n", sut.description.name,
                   sut.description.version_text, compared, worst);
    }

    FmuUnderTest sut;
    Expected expected;
    double worst{0};
    int compared{0};
};

class ReferenceFmus : public ::testing::Test {
  protected:
    void SetUp() override {
        char const* const fmus = std::getenv("GRIDSPACE_REFERENCE_FMUS");
        char const* const results = std::getenv("GRIDSPACE_REFERENCE_RESULTS");
        if (fmus == nullptr || results == nullptr) {
            GTEST_SKIP() << "GRIDSPACE_REFERENCE_FMUS and GRIDSPACE_REFERENCE_RESULTS name no folders";
        }
        fmus_ = fmus;
        results_ = results;
    }
    std::filesystem::path fmus_, results_;
};

TEST_F(ReferenceFmus, GiveTheResultsThatTheirProjectPublishes) {
    for (int const version : {2, 3}) {
        for (char const* model : {"BouncingBall", "Dahlquist", "Feedthrough", "Stair", "VanDerPol"}) {
            SCOPED_TRACE(fmt::format("{} of FMI {}.0", model, version));
            ReferenceFmu{fmus_, results_, version, model}.run();
        }
    }
}

TEST_F(ReferenceFmus, GiveTheLimitsOfEachTypeBackThatTheyWereGiven) {
    using Whole = std::numeric_limits<std::int64_t>;
    using Natural = std::numeric_limits<std::uint64_t>;
    FmuUnderTest sut{fmus_ / "fmi3/Feedthrough.fmu"};
    sut.begin();
    std::vector<std::pair<std::string, Value>> const values{
        {"Float32_continuous", 0.5},
        {"Float64_continuous", 0.1},
        {"Int8", std::int64_t{-128}},
        {"UInt8", std::uint64_t{255}},
        {"Int16", std::int64_t{-32768}},
        {"UInt16", std::uint64_t{65535}},
        {"Int32", std::int64_t{-2147483648LL}},
        {"UInt32", std::uint64_t{4294967295U}},
        {"Int64", Whole::min()},
        {"UInt64", Natural::max()},
        {"Boolean", true},
        {"String", std::string{"pump 1"}},
        {"Enumeration", std::int64_t{2}},
    };
    for (auto const& [name, value] : values) {
        sut.set(name + "_input", value);
    }
    ASSERT_TRUE(advance(*sut.instance, sut.can(), "Feedthrough", 0, 0.1));
    for (auto const& [name, value] : values) {
        EXPECT_EQ(sut.get(name + "_output"), value) << name;
    }
}

} // namespace
} // namespace gridspace::fmi
