// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <tinyxml2.h>
#include <vector>

/// Reading XML without caring for prefixes: real SCL files use several, or none.
namespace gridspace::scl {

using Element = tinyxml2::XMLElement;

[[nodiscard]] inline std::string_view local_name(Element const& element) {
    std::string_view const name = element.Name();
    std::size_t const colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

[[nodiscard]] inline std::vector<Element const*> children(Element const& parent, std::string_view name) {
    std::vector<Element const*> out;
    for (Element const* e = parent.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        if (local_name(*e) == name) {
            out.push_back(e);
        }
    }
    return out;
}

[[nodiscard]] inline Element const* child(Element const& parent, std::string_view name) {
    auto const all = children(parent, name);
    return all.empty() ? nullptr : all.front();
}

[[nodiscard]] inline std::string attribute(Element const& element, char const* name, std::string fallback = {}) {
    char const* const value = element.Attribute(name);
    return value == nullptr ? std::move(fallback) : value;
}

/// The text without the space around it; comments may stand in between.
[[nodiscard]] inline std::string text_of(Element const& element) {
    std::string out;
    for (tinyxml2::XMLNode const* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
        out += node->ToText() != nullptr ? node->Value() : "";
    }
    std::size_t const first = out.find_first_not_of(" \t\r\n");
    return first == std::string::npos ? "" : out.substr(first, out.find_last_not_of(" \t\r\n") - first + 1);
}

} // namespace gridspace::scl
