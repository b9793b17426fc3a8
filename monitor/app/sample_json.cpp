// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/sample_json.hpp"

#include "common/idl/cdr_visitor.hpp"
#include "common/idl/key.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFields = 1000; ///< of one sample, in a page

struct ToJson final : idl::Visitor {
    explicit ToJson(idl::KeyFinder const& finder) : key_finder{finder} {}

    idl::KeyFinder const& key_finder;
    Json fields = Json::object();
    std::string key;
    bool cut{false};

    void leaf(std::string_view path, idl::Type const& type, idl::Value const& value) override {
        std::string const name{path};
        if (key_finder.covers(path)) {
            key += (key.empty() ? "" : "/") + idl::to_text(value);
        }
        if (fields.size() >= kMaxFields) {
            cut = true;
            return;
        }
        if (type.kind == idl::Kind::enumeration) {
            double const number = idl::to_number(value);
            for (auto const& [label, v] : type.values) {
                if (static_cast<double>(v) == number) {
                    fields[name] = label;
                    return;
                }
            }
        }
        std::visit([&](auto const& v) { fields[name] = v; }, value); // NaN and infinities become null in dump()
    }
};

} // namespace

Json sample_to_json(std::string const& idl, std::string const& type, std::span<std::byte const> cdr) {
    if (idl.empty()) {
        return {{"error", "nobody has published the IDL of type " + type}};
    }
    auto const model = idl::parse(idl, idl::Unsupported::kept);
    auto const index = model ? model->find(type) : std::nullopt;
    if (!index) {
        return {{"error", model ? "its IDL text does not define the type" : "its IDL text: " + model.error().message}};
    }
    if (std::string const& why = model->types[*index].unsupported; !why.empty()) {
        return {{"error", "samples of " + type + " cannot be decoded: its IDL, " + why}};
    }
    idl::KeyFinder const key_finder{*model, *index};
    ToJson visitor{key_finder};
    if (auto ok = idl::visit(*model, *index, cdr, visitor); !ok) {
        return {{"error", "the sample is not of that type: " + ok.error().message}};
    }
    Json out{{"key", visitor.key}, {"fields", std::move(visitor.fields)}};
    if (visitor.cut) {
        out["cut"] = true;
    }
    return out;
}

} // namespace gridspace::monitor
