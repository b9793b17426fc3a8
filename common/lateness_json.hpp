// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/lateness.hpp"

#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace gridspace {

/// How late a process or a machine was, as JSON: period_us, instants, p50_us, p99_us, p999_us, worst_us,
/// later_than_a_period.
[[nodiscard]] nlohmann::ordered_json to_json(Lateness::Summary const& summary);
/// Nothing if the text has no instants.
[[nodiscard]] std::optional<Lateness::Summary> lateness_of(nlohmann::ordered_json const& json);

} // namespace gridspace
