// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_values.hpp"

#include "gateways/gateway/gateway_config.hpp"
#include "gateways/mapping/record_type.hpp"

namespace gridspace::agents {

using fmi::Type;
using mapping::BasicType;

namespace {

std::optional<BasicType> basic_type(Type type) {
    switch (type) {
    case Type::float32:
        return BasicType::float32;
    case Type::float64:
        return BasicType::float64;
    case Type::int8:
        return BasicType::int8;
    case Type::uint8:
        return BasicType::uint8;
    case Type::int16:
        return BasicType::int16;
    case Type::uint16:
        return BasicType::uint16;
    case Type::int32:
        return BasicType::int32;
    case Type::uint32:
        return BasicType::uint32;
    case Type::int64:
    case Type::enumeration: // by its number
        return BasicType::int64;
    case Type::uint64:
        return BasicType::uint64;
    case Type::boolean:
        return BasicType::boolean;
    case Type::string:
        return BasicType::visible_string;
    default:
        return std::nullopt;
    }
}

} // namespace

std::optional<mapping::Field> field_of(fmi::Variable const& variable) {
    auto const type = basic_type(variable.type);
    if (!type || variable.is_array) {
        return std::nullopt;
    }
    std::uint16_t const length = *type == BasicType::visible_string ? mapping::RecordType::kTextOctets : 0;
    return mapping::Field{gateways::field_path(variable.name), *type, length,
                          mapping::is_unit(variable.unit) ? variable.unit : ""};
}

fmi::Value to_fmi(mapping::Value const& value) {
    if (iec61850::is_float(value.type)) {
        return value.number();
    }
    if (iec61850::is_unsigned(value.type)) {
        return value.bits;
    }
    if (value.type == BasicType::boolean) {
        return value.boolean();
    }
    if (iec61850::is_string(value.type)) {
        return std::string{reinterpret_cast<char const*>(value.text.data()), value.text.size()};
    }
    return value.as_signed();
}

mapping::Value to_mapping(fmi::Value const& value, BasicType type) {
    struct Visitor {
        BasicType type;
        mapping::Value operator()(double v) const {
            return type == BasicType::float32 ? mapping::Value::of(static_cast<float>(v)) : mapping::Value::of(v);
        }
        mapping::Value operator()(std::int64_t v) const { return mapping::Value::integer(type, v); }
        mapping::Value operator()(std::uint64_t v) const { return {type, 0, v, {}}; }
        mapping::Value operator()(bool v) const { return mapping::Value::of(v); }
        mapping::Value operator()(std::string const& v) const { return mapping::Value::visible(v); }
    };
    return std::visit(Visitor{type}, value);
}

} // namespace gridspace::agents
