// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {
struct Network;
}

namespace gridspace::launcher {

/// Kinds of elements that a setting of a program may name: "bus", "ev", "line", …
[[nodiscard]] std::vector<std::string> element_kinds();
/// As messages say it: "EV".
[[nodiscard]] std::string title_of_kind(std::string_view kind);
/// Nothing when there is no such kind.
[[nodiscard]] std::optional<std::vector<std::string>> element_names(sim::Network const& network, std::string_view kind);
/// A quantity of an element as a configuration writes it ("24"). Nothing when there is no such element or quantity.
[[nodiscard]] std::optional<std::string> element_quantity(sim::Network const& network, std::string_view kind,
                                                          std::string_view element, std::string_view quantity);

} // namespace gridspace::launcher
