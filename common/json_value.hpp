// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>

namespace gridspace {

/// A member of a JSON object of which nobody knows who wrote it: `otherwise` where there is none, or one of another
/// kind (the library's own value() throws then). `Json`: any nlohmann::basic_json.
template <class T, class Json>
T value_of(Json const& object, char const* key, T otherwise) {
    auto const it = object.is_object() ? object.find(key) : object.end();
    if (it == object.end()) {
        return otherwise;
    }
    if constexpr (std::is_same_v<T, std::string>) {
        return it->is_string() ? it->template get<T>() : otherwise;
    } else if constexpr (std::is_same_v<T, bool>) {
        return it->is_boolean() ? it->template get<T>() : otherwise;
    } else if constexpr (std::is_same_v<T, Json>) {
        return *it;
    } else if constexpr (std::is_integral_v<T>) {
        return it->is_number_integer() ? it->template get<T>() : otherwise; // 1e300 is none
    } else {
        return it->is_number() ? it->template get<T>() : otherwise;
    }
}

/// A member that is a text; an empty one where there is none.
template <class Json>
std::string text_of(Json const& object, char const* key) {
    return value_of(object, key, std::string{});
}

/// A member that is an object; an empty one where there is none.
template <class Json>
Json part_of(Json const& object, char const* key) {
    Json part = value_of(object, key, Json::object());
    return part.is_object() ? part : Json::object();
}

} // namespace gridspace
