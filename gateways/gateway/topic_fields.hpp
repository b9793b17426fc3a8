// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/gateway_config.hpp"
#include "gateways/mapping/record_type.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

namespace gridspace::gateways {

/// The IDL text that defines a type; empty for an unknown one.
using FindIdl = std::function<std::string_view(std::string_view type)>;

/// The type of a topic as fields with units: those that their names end with.
struct TopicFields {
    std::shared_ptr<mapping::RecordType const> type;
    std::vector<mapping::Field> fields;
};

/// Nothing when the type is not known or cannot be mapped, which is then in `diagnostics`. `each` may be empty.
[[nodiscard]] std::optional<TopicFields> topic_fields(config::Ref const& type, config::Ref const& each,
                                                      FindIdl const& find_idl, config::Diagnostics& diagnostics);

/// The unit that a name ends with: "p_kw" is in kW. Empty when it has none that can be converted.
[[nodiscard]] std::string unit_of_name(std::string_view name);

} // namespace gridspace::gateways
