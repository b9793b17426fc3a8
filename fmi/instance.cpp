// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/instance.hpp"

#include "common/text.hpp"
#include "fmi/instances.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace gridspace::fmi {
namespace {

/// FMI 2.0 wants the folder of resources as a URI (RFC 3986): "file:///run/my%20model/resources".
std::string uri_of(std::filesystem::path const& folder) {
    std::string out = "file://";
    for (char const c : folder.string()) {
        bool const plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view{"/-._~"}.contains(c);
        out += plain ? std::string{c} : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

} // namespace

Result<void> complain_of_missing(SharedObject const& object, ModelDescription const& description) {
    if (object.missing().empty()) {
        return {};
    }
    std::string const identifier = description.co_simulation ? description.co_simulation->identifier : "";
    bool const prefixed = object.has(identifier + "_" + object.missing().front());
    std::vector<std::string> some = object.missing();
    some.resize(std::min<std::size_t>(some.size(), 5));
    return fail(
        ExitCode::usage,
        fmt::format("{}: its binary lacks {} functions of FMI {}: {}{}", description.file, object.missing().size(),
                    name_of(description.version), join(some, ", "),
                    some.size() < object.missing().size() ? ", ..." : ""),
        prefixed ? fmt::format("they begin with '{}_', as for static linking: compile it without a prefix", identifier)
                 : "is it of another version than its description says?");
}

Result<std::unique_ptr<Instance>> instantiate(ModelDescription const& description, std::filesystem::path const& folder,
                                              std::string const& binary, std::string const& name, Host& host) {
    std::filesystem::path const root = std::filesystem::absolute(folder);
    auto object = SharedObject::load(root / binary, description.file, host);
    if (!object) {
        return std::unexpected{object.error()};
    }
    std::filesystem::path const resources = root / "resources";
    return description.version == Version::fmi2
               ? make_instance2(std::move(*object), description, uri_of(resources), name, host)
               : make_instance3(std::move(*object), description, resources.string() + "/", name, host);
}

} // namespace gridspace::fmi
