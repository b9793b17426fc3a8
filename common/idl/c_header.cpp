// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/c_header.hpp"

#include <array>
#include <fmt/format.h>

namespace gridspace::idl {
namespace {

std::string c_name(std::string name) {
    for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::", at)) {
        name.replace(at, 2, "_");
    }
    return name;
}

std::string c_type(Model const& model, std::size_t index) {
    static constexpr std::array<std::string_view, 12> kNumbers{"bool",    "uint8_t",  "char",    "int8_t",
                                                               "int16_t", "uint16_t", "int32_t", "uint32_t",
                                                               "int64_t", "uint64_t", "float",   "double"};
    Type const& type = model.types[index];
    switch (type.kind) {
    case Kind::string:
        return "char const*";
    case Kind::enumeration:
        return "int32_t";
    case Kind::structure:
        return c_name(type.name);
    case Kind::sequence: {
        bool const of_arrays = model.types[type.element].kind == Kind::array; // they have no name to point to
        return fmt::format("struct {{ uint32_t length; {} const* items; }}",
                           of_arrays ? "void" : c_type(model, type.element));
    }
    case Kind::array:
        return c_type(model, type.element);
    default:
        return std::string{kNumbers.at(static_cast<std::size_t>(type.kind))};
    }
}

std::string dimensions(Model const& model, std::size_t index) {
    Type const& type = model.types[index];
    return type.kind == Kind::array ? fmt::format("[{}]{}", type.bound, dimensions(model, type.element)) : "";
}

std::string remark(Type const& type) {
    if (type.kind == Kind::enumeration) {
        return " /* " + c_name(type.name) + " */";
    }
    return type.bound != 0 && (type.kind == Kind::string || type.kind == Kind::sequence)
               ? fmt::format(" /* at most {} */", type.bound)
               : "";
}

} // namespace

void CHeader::add(NativeLayout const& layout) {
    add(layout, layout.type());
}

void CHeader::add(NativeLayout const& layout, std::size_t index) {
    Model const& model = layout.model();
    Type const& type = model.types[index];
    if (type.kind == Kind::sequence || type.kind == Kind::array) {
        return add(layout, type.element);
    }
    if ((type.kind != Kind::structure && type.kind != Kind::enumeration) || !known_.insert(type.name).second) {
        return;
    }
    std::string const name = c_name(type.name);
    if (type.kind == Kind::enumeration) {
        std::string values;
        for (auto const& [value, number] : type.values) {
            values += fmt::format("{}{}_{} = {}", values.empty() ? "" : ", ", name, value, number);
        }
        declarations_ += fmt::format("enum {{ {} }};\n\n", values);
        return;
    }
    std::string body;
    for (Type::Member const& member : type.members) {
        add(layout, member.type);
        body += fmt::format("    {} {}{};{}\n", c_type(model, member.type), member.name, dimensions(model, member.type),
                            remark(model.types[member.type]));
    }
    declarations_ += fmt::format("typedef struct {} {{\n{}}} {};\n\n", name, body, name);
    type_names_ += fmt::format("template <> struct TypeName<{}> {{ static constexpr char const* value = \"{}\"; }};\n",
                               name, type.name);
}

std::string CHeader::text(std::string_view origin) const {
    return fmt::format("/* {} Strings end with NUL; time_ns is set when a sample is written. */\n"
                       "#pragma once\n\n#include <stdbool.h>\n#include <stdint.h>\n\n"
                       "#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n{}#ifdef __cplusplus\n}} // extern \"C\"\n\n"
                       "namespace gridspace {{\ntemplate <class T> struct TypeName; // on the wire\n{}}} // namespace "
                       "gridspace\n#endif\n",
                       origin, declarations_, type_names_);
}

} // namespace gridspace::idl
