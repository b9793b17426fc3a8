// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include "tests/support/cdr_sample.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

constexpr std::int64_t kPeriodNs = 10;

/// Rows of the signals x.A, x.B and x.C of 'sim', which hold the number of the row; some in one frame.
void give(SignalReader& sut, std::int64_t rows, std::uint32_t rows_in_frame) {
    CdrSample catalog;
    catalog.text("sim");
    catalog.text("g");
    catalog.number(0.0);
    catalog.number(std::uint32_t{3});
    for (char const* signal : {"x.A", "x.B", "x.C"}) {
        catalog.text(signal);
        catalog.text("V");
    }
    ASSERT_TRUE(sut.take("signal_catalog", catalog.octets()));
    for (std::int64_t row = 0; row < rows; row += rows_in_frame) {
        CdrSample frame;
        frame.text("sim");
        frame.text("g");
        frame.number(rows_in_frame);
        for (std::int64_t r = row; r < row + rows_in_frame; ++r) {
            frame.number(r * kPeriodNs);
        }
        frame.number(3 * rows_in_frame);
        for (std::int64_t r = row; r < row + rows_in_frame; ++r) {
            for (int column = 0; column < 3; ++column) {
                frame.number(static_cast<double>(r));
            }
        }
        ASSERT_TRUE(sut.take("signals", frame.octets()));
    }
}

Keep by_last_letter(std::string const& source, std::string const& signal) {
    EXPECT_EQ(source, "sim");
    return signal.ends_with('A') ? Keep::all : signal.ends_with('B') ? Keep::spans : Keep::none;
}

using Times = std::vector<std::int64_t>;

TEST(SignalReader, KeepsOfSpansWhatHoldsInThemAndTheLastRow) {
    for (std::uint32_t const rows_in_frame : {1U, 4U}) {
        // The first begins between two rows, the second is one instant between two, the third meets a row.
        SignalReader sut{by_last_letter, {{25, 40}, {75, 75}, {90, 90}}};
        give(sut, 12, rows_in_frame);
        EXPECT_EQ(sut.signals().at("x.A").times_ns.size(), 12U);
        EXPECT_EQ(sut.signals().at("x.B").times_ns, (Times{20, 30, 40, 70, 90, 110}));
        EXPECT_EQ(sut.signals().at("x.B").values, (std::vector<double>{2, 3, 4, 7, 9, 11}));
        EXPECT_EQ(sut.signals().at("x.B").unit, "V");
        EXPECT_FALSE(sut.signals().contains("x.C"));
    }
}

TEST(SignalReader, WithoutSpansKeepsTheLastRow) {
    SignalReader sut{by_last_letter};
    give(sut, 8, 4);
    EXPECT_EQ(sut.signals().at("x.B").times_ns, (Times{70}));
}

} // namespace
} // namespace gridspace
