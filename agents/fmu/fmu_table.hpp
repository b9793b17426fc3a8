// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/fmu/fmu_config.hpp"
#include "fmi/instance.hpp"
#include "gateways/gateway/topic_fields.hpp"
#include "gateways/mapping/mapping.hpp"

#include <string>
#include <vector>

namespace gridspace::agents {

/// The settings of an FMU agent, checked against what its FMU says of itself and the types of its topics: what it needs
/// to run. Variables are meant by their place in the description.
struct FmuTable {
    std::vector<mapping::Field> variables; ///< those that cannot be mapped have no name

    struct Start {
        std::size_t variable{0};
        fmi::Value value;
    };
    std::vector<Start> start;

    struct Filter {
        std::size_t field{0};
        mapping::Value value; ///< points into the text of the settings
    };
    struct Input {
        gateways::MappingEnd from;
        gateways::TopicFields type;
        mapping::Mapping rules;
        std::vector<std::size_t> written; ///< variables
        std::vector<Filter> filters;
    };
    struct Output {
        std::string topic, type_name;
        std::vector<gateways::FieldRule> fields; ///< constants point into their texts
        gateways::TopicFields type;
        mapping::Mapping rules;
        std::vector<std::size_t> written;      ///< fields of the topic, time_ns included
        std::optional<std::size_t> time_field; ///< time_ns
        std::vector<std::size_t> read;         ///< variables
    };
    std::vector<Input> inputs;
    std::vector<Output> outputs;
    std::vector<std::size_t> watched;
    std::vector<std::size_t> read; ///< variables that are needed at each communication point
};

/// Everything that is wrong is in `diagnostics`, at its place in the file. `config` must outlive the table.
[[nodiscard]] FmuTable make_table(FmuConfig const& config, fmi::ModelDescription const& description,
                                  std::string const& process, gateways::FindIdl const& find_idl,
                                  config::Diagnostics& diagnostics);

/// "agent.PROCESS.VARIABLE", with '_' for what cannot be in the name of a signal.
[[nodiscard]] std::string signal_name(std::string const& process, std::string const& variable);

} // namespace gridspace::agents
