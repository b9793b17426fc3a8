// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// One key of a configuration file, as its description tells it.
struct SchemaKey {
    enum class Kind {
        number,
        integer,
        fraction,
        text,
        name,
        file,
        flag,
        word,
        numbers,
        names,
        integers,
        any,
        object,
        map,
        list
    };
    std::string key, doc;
    Kind kind{Kind::any};
    bool required{false};
    std::string default_text;           ///< empty: none
    std::optional<double> min, max;     ///< inclusive
    std::optional<double> above, below; ///< exclusive
    std::vector<std::string> words;     ///< of a word
    std::vector<SchemaKey> children;    ///< of an object, a map's entries, a list's items
};

/// Runs a description and gathers its keys; nothing is read, mistakes are not looked for.
[[nodiscard]] std::vector<SchemaKey> keys_of(std::function<void(config::Fields&)> const& describe);

} // namespace gridspace::launcher
