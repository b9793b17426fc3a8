// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::config {

/// One key of a configuration file, from its description.
struct Key {
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
    std::string default_text{};             ///< empty: none
    std::optional<double> min{}, max{};     ///< inclusive
    std::optional<double> above{}, below{}; ///< exclusive
    std::vector<std::string> words{};       ///< of a word; of a fraction what may stand in its place
    std::vector<Key> children{};            ///< of an object, a map's entries, a list's items
};

/// Runs a description and gathers its keys; nothing is read, mistakes are not looked for.
[[nodiscard]] std::vector<Key> keys_of(std::function<void(Fields&)> const& describe);
/// The keys of a type that has a `describe` of its own.
template <class Config>
[[nodiscard]] std::vector<Key> keys_of() {
    return keys_of([](Fields& f) {
        Config any;
        describe(f, any);
    });
}

/// The other way round: reads a map by keys that another program has described. Mistakes are reported as for a
/// description in code; nothing is kept, the values are in the tree.
void read_keys(Fields& fields, std::vector<Key> const& keys);

/// "number", "names", …: as a program's description names a kind.
[[nodiscard]] std::string_view kind_name(Key::Kind kind);
[[nodiscard]] std::optional<Key::Kind> kind_of_name(std::string_view name);

} // namespace gridspace::config
