// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

TEST(WireDelays, OfColumnsOfDifferentLengthEndWithTheShortest) {
    SignalStore signals;
    auto const put = [&](std::string const& name, std::size_t rows) {
        SignalSeries& series = signals["stream.TRIP2." + name];
        for (std::size_t i = 0; i < rows; ++i) {
            series.times_ns.push_back(static_cast<std::int64_t>(i));
            series.values.push_back(static_cast<double>(i));
        }
    };
    put("sent_after_ms", 100'000);
    put("heard_after_ms", 100'000);
    for (char const* name : {"st_num", "sq_num", "heard_st_num"}) {
        put(name, 3);
    }
    put("heard_sq_num", 2);
    derive_wire_delays(signals);
    EXPECT_EQ(signals.at("stream.TRIP2.wire_delay_ms").values, (std::vector<double>{0, 0}));
}

} // namespace
} // namespace gridspace
