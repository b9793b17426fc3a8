// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/lateness_json.hpp"

#include "common/json_value.hpp"

#include <nlohmann/json.hpp>

namespace gridspace {

nlohmann::ordered_json to_json(Lateness::Summary const& summary) {
    return {{"period_us", summary.period_us},
            {"instants", summary.instants},
            {"p50_us", summary.p50_us},
            {"p99_us", summary.p99_us},
            {"p999_us", summary.p999_us},
            {"worst_us", summary.worst_us},
            {"later_than_a_period", summary.later_than_a_period}};
}

std::optional<Lateness::Summary> lateness_of(nlohmann::ordered_json const& json) {
    Lateness::Summary const out{value_of(json, "period_us", 0.0),
                                value_of(json, "instants", std::uint64_t{0}),
                                value_of(json, "later_than_a_period", std::uint64_t{0}),
                                value_of(json, "p50_us", 0.0),
                                value_of(json, "p99_us", 0.0),
                                value_of(json, "p999_us", 0.0),
                                value_of(json, "worst_us", 0.0)};
    return out.instants == 0 ? std::nullopt : std::optional{out};
}

} // namespace gridspace
