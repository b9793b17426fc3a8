// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"
#include "common/result.hpp"
#include "sim/opendss/dss_classes.hpp"
#include "sim/opendss/dss_words.hpp"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::opendss {

/// A property that a command gave a value.
struct Assignment {
    std::size_t property{0}; ///< of the class
    Word value;
    bool begins{false}; ///< the first of its command: OpenDSS evaluates an object after each command
};

/// What a script says about one object: the values in the order of the script.
struct Object {
    ClassInfo const* info{nullptr};
    std::string name;
    config::SourceMark where; ///< where it was made
    std::vector<Assignment> assignments;
    std::set<std::pair<int, int>> open; ///< terminal, conductor from 1; conductor 0: all of them
};

/// Something of the script that is not part of the power flow.
struct LeftOut {
    config::SourceMark where;
    std::string what;           ///< "storage.battery", "command 'visualize'"
    bool changes_result{false}; ///< OpenDSS's solution would be another
};

/// A script as it stands at its end.
struct Script {
    std::string circuit; ///< its name; empty without `New Circuit`
    std::vector<Object> objects;
    std::map<std::string, std::size_t> index;            ///< of an object, by "class.name" in lower case
    std::map<std::string, Word> options;                 ///< what `set` said last, by its name in lower case
    std::vector<std::pair<std::string, Word>> bus_bases; ///< `setkvbase`: bus, kV line to line
    std::vector<LeftOut> left_out;
    int solves{0};
    bool changed_since_solve{false};

    [[nodiscard]] Object const* find(std::string_view class_name, std::string_view name) const;
};

/// A file of the script.
struct DssFile {
    std::string text;
    std::string name;   ///< for messages
    std::string folder; ///< where its relative paths start
};

/// Gives a file by its folder and the path that the script wrote.
using ReadDssFile = std::function<Result<DssFile>(std::string const& folder, std::string const& path)>;

// What a script may cost at most; each is an error that names the limit.
inline constexpr int kMaxDepth = 32;                   ///< files that redirect to each other
inline constexpr std::size_t kMaxOctets = 256U << 20U; ///< of all files together
inline constexpr std::size_t kMaxObjects = 500'000;
inline constexpr std::size_t kMaxAssignments = 4'000'000; ///< values of all objects, `like` and `batchedit` included

/// Runs a script up to its end without solving anything. What is wrong is in `diagnostics`.
[[nodiscard]] Script run_script(DssFile const& main, ReadDssFile const& read, config::Diagnostics& diagnostics,
                                std::vector<std::string> const& commands_after = {});

} // namespace gridspace::opendss
