// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/schema/schema_definitions.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWorthwhile = 60; // characters: a reference is not longer than what it replaces

/// The keywords under which a schema holds others, by name or in a list.
bool holds_by_name(std::string const& keyword) {
    return keyword == "properties";
}
bool holds_one(std::string const& keyword) {
    return keyword == "additionalProperties" || keyword == "items";
}

class Definitions {
  public:
    void count(Json const& schema) {
        if (!schema.is_object() || ++seen_[schema.dump()] > 1) {
            return; // what is in a part that repeats repeats with it
        }
        each_part(schema, "", [&](std::string const&, Json const& part) { count(part); });
    }

    /// The schema with references for its parts, and, unless it is the root, a reference for itself.
    Json referring(Json const& schema, std::string const& name, bool root = false) {
        if (!schema.is_object()) {
            return schema;
        }
        std::string const text = schema.dump();
        bool const shared = !root && seen_[text] > 1 && text.size() >= kWorthwhile;
        if (auto const known = names_.find(text); shared && known != names_.end()) {
            return Json{{"$ref", "#/$defs/" + known->second}};
        }
        Json out = schema;
        each_part(out, name, [&](std::string const& part_name, Json& part) { part = referring(part, part_name); });
        if (!shared) {
            return out;
        }
        std::string own = name;
        for (int number = 2; definitions.contains(own); ++number) {
            own = name + "_" + std::to_string(number);
        }
        names_[text] = own;
        definitions[own] = std::move(out);
        return Json{{"$ref", "#/$defs/" + own}};
    }

    Json definitions = Json::object();

  private:
    /// `part_name`: the key that a part belongs to.
    template <class Schema, class Visit>
    static void each_part(Schema& schema, std::string const& name, Visit const& visit) {
        for (auto& [keyword, value] : schema.items()) {
            if (holds_by_name(keyword)) {
                for (auto& [key, part] : value.items()) {
                    visit(key, part);
                }
            } else if (keyword == "anyOf") {
                for (auto& part : value) {
                    visit(name, part);
                }
            } else if (holds_one(keyword)) {
                visit(name, value);
            }
        }
    }

    std::map<std::string, int> seen_;
    std::map<std::string, std::string> names_; ///< by what they stand for
};

std::string to_lines(Json const& json, std::size_t indent) {
    constexpr std::size_t kLine = 120;
    std::string text = json.dump();
    if (!json.is_structured() || json.empty() || indent + text.size() + 20 <= kLine) {
        return text;
    }
    std::string out;
    for (auto const& [key, value] : json.items()) {
        out += (out.empty() ? "\n" : ",\n") + std::string(indent + 1, ' ');
        out += json.is_object() ? Json(key).dump() + ": " : "";
        out += to_lines(value, indent + 1);
    }
    return (json.is_object() ? "{" : "[") + out + "\n" + std::string(indent, ' ') + (json.is_object() ? "}" : "]");
}

} // namespace

std::string with_definitions(std::string const& schema) {
    Json const root = Json::parse(schema);
    Definitions definitions;
    definitions.count(root);
    Json out = definitions.referring(root, "root", true);
    out["$defs"] = std::move(definitions.definitions);
    return to_lines(out, 0) + "\n";
}

} // namespace gridspace::launcher
