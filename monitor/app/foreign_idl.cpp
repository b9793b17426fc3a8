// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/foreign_idl.hpp"

#include "common/idl/idl_model.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::monitor {

Result<std::map<std::string, std::string>> read_foreign_idl(std::filesystem::path const& file) {
    std::ifstream stream{file};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    if (!stream) {
        return fail(ExitCode::usage, fmt::format("cannot read '{}'", file.string()));
    }
    auto const model = idl::parse(text, idl::Unsupported::kept);
    if (!model) {
        return fail(ExitCode::usage, fmt::format("'{}': {}", file.string(), model.error().message),
                    model.error().remedy);
    }
    std::map<std::string, std::string> out;
    for (idl::Type const& type : model->types) {
        if (type.kind == idl::Kind::structure || (type.kind == idl::Kind::unsupported && !type.name.empty())) {
            out.try_emplace(type.name, text);
        }
    }
    if (out.empty()) {
        return fail(ExitCode::usage, fmt::format("'{}' defines no struct", file.string()));
    }
    return out;
}

} // namespace gridspace::monitor
