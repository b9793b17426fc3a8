// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/key.hpp"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::program {

/// A topic that a program reads or writes, or a stream of the scenario. `topic` may be a pattern (see expand()):
/// "{from}" is what its setting says.
struct Topic {
    std::string topic;
    std::string type{};        ///< name of the type on the wire
    bool triggers{false};      ///< reading side: a sample makes the program work in the same tick
    bool optional{false};      ///< reading side: nobody has to write it; writing side: nobody has to read it
    std::string idl{};         ///< file that defines the type when it is not ours, from the folder of the program
    bool is_stream{false};     ///< sampled values or GOOSE on the process's link; its data set says the type
    std::int64_t endpoints{1}; ///< readers or writers that it has on the topic; of our own programs
    struct Only {
        std::string member; ///< a text
        std::string is;     ///< a pattern; with several values each will do, with none everything will
    };
    std::vector<Only> only{}; ///< reading side: samples with other members are not handed over
};

/// A signal that a program publishes. `name` may be a pattern.
struct Signal {
    std::string name;
    std::string unit{};
    double rate_hz{0}; ///< 0: when something changes
};

/// A setting that names elements of the grid: `ev: EV1`, `evs: [EV1, EV2]`, or `evs: {EV1: {...}}`.
struct ElementUse {
    std::string key;
    std::string kind;   ///< "ev"
    std::string does{}; ///< "acts for": what two processes must not do for one element; empty: they may
    struct Default {
        std::string key;      ///< setting next to the name
        std::string quantity; ///< of the element, which is taken when the setting is not given
    };
    std::vector<Default> defaults{};
};

/// What a program says of itself, once, for everybody: launcher, validation, schema, documentation, its own shell.
/// `PROGRAM --describe` prints it as JSON (docs/reference/program_description.md).
struct Declaration {
    std::string name;           ///< "gridspace-ev"
    std::string description;    ///< one line, without a full stop
    std::string role{"member"}; ///< QoS role when a process names none: qos/<role>.xml
    bool member{true};          ///< takes part in the barrier in lockstep
    bool daemon{false}; ///< started as ours are: --config FILE --log-level LEVEL --status-fd N; others: as they are
    std::vector<config::Key> settings{};
    std::vector<std::string> whole_steps{}; ///< settings that must be whole multiples of the simulation step
    std::string latency{}; ///< the setting, in microseconds, that says how long it takes from input to output
    // Lockstep, and of our own programs: nobody checks such a promise.
    bool promises_latency{false}; ///< what it sends up to its latency after an input has been sent by then
    bool works_ahead{false};      ///< its ticks may end later than the clock's, where its input is complete so far
    std::vector<ElementUse> elements{};
    std::vector<Topic> reads{}, writes{};
    std::vector<Signal> signals{};
};

/// Values of a setting as names: one for a scalar, several for a list or the names of a map. "process" is the process.
using Values = std::function<std::vector<std::string>(std::string_view key)>;

/// Patterns filled in. "{KEY}" stands for the value of a setting, "{a|b}" for those of both; with several values there
/// are several names. What stands in brackets is left out when there is one value only: "agent.{process}[.{ev}].v_pu".
[[nodiscard]] std::vector<std::string> expand(std::string_view pattern, Values const& values);
/// The values of the pattern's placeholder, in the order of expand(): one that is empty when it has none.
[[nodiscard]] std::vector<std::string> placeholder_values(std::string_view pattern, Values const& values);
/// Signals in a row with the same keys stay together: all of the first element, all of the second.
[[nodiscard]] std::vector<Signal> expand(std::vector<Signal> const& signals, Values const& values);
[[nodiscard]] std::vector<Topic> expand(std::vector<Topic> const& topics, Values const& values);

/// Appends a topic that is not there yet: however often it is used, there is one reader or writer.
void add_once(std::vector<Topic>& topics, Topic topic);

/// JSON, indented; `version` is the program's.
[[nodiscard]] std::string to_json(Declaration const& declaration, std::string_view version);
/// Mistakes are named by line and column of `source`, a name for the text. Nothing when there are any.
[[nodiscard]] std::optional<Declaration> from_json(std::string const& text, std::string const& source,
                                                   config::Diagnostics& diagnostics);

} // namespace gridspace::program
