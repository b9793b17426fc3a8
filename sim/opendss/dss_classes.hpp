// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace gridspace::opendss {

/// What we make of the objects of a class.
enum class Treatment {
    modelled,       ///< part of the power flow
    without_effect, ///< meters, curves of protection: nothing of a static solution depends on them
    left_out,       ///< the solution differs from that of OpenDSS without them
};

struct ClassInfo {
    std::string_view name;
    Treatment treatment;
    std::vector<std::string_view> properties; ///< in OpenDSS's order, which positional values follow
};

/// A class by its name in lower case; nothing for one that OpenDSS does not have either.
[[nodiscard]] ClassInfo const* find_class(std::string_view name);
[[nodiscard]] std::vector<std::string_view> class_names();

/// A property by its name in lower case or the beginning of it: of several the first, as in OpenDSS.
[[nodiscard]] std::optional<std::size_t> find_property(ClassInfo const& info, std::string_view name);

} // namespace gridspace::opendss
