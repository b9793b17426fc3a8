// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/topic_fields.hpp"

#include "gateways/mapping/mapping.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {

std::string unit_of_name(std::string_view name) {
    std::string_view const last = name.substr(std::min(name.rfind('.') + 1, name.size()));
    std::string_view const unit = config::unit_of_key(last);
    std::string const known{unit == "p.u." ? "pu" : unit == "degrees" ? "deg" : unit};
    return mapping::is_unit(known) ? known : "";
}

std::optional<TopicFields> topic_fields(Ref const& type, Ref const& each, FindIdl const& find_idl,
                                        config::Diagnostics& diagnostics) {
    auto const refuse = [&](Ref const& at, std::string message, std::string hint) {
        diagnostics.error(at.where, std::move(message), std::move(hint), static_cast<int>(at.name.size()));
        return std::nullopt;
    };
    std::string_view const idl = find_idl(type.name);
    if (idl.empty()) {
        return refuse(type, fmt::format("no IDL file of this build defines the type '{}'", type.name),
                      "put its IDL file into idl/user and build again (docs/how_to/use_the_gateway.md)");
    }
    auto const model = idl::parse(idl);
    if (!model) {
        return refuse(type, fmt::format("the IDL of '{}': {}", type.name, model.error().message), model.error().remedy);
    }
    auto made = mapping::RecordType::create(*model, type.name, each.name);
    if (!made) {
        return refuse(each.empty() ? type : each, made.error().message, made.error().remedy);
    }
    TopicFields out{std::make_shared<mapping::RecordType const>(std::move(*made)), {}};
    out.fields = out.type->fields();
    for (mapping::Field& field : out.fields) {
        field.unit = unit_of_name(field.name);
    }
    return out;
}

} // namespace gridspace::gateways
