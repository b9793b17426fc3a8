// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::recorder {

/// Settings of gridspace-recorder.
/// Which frames are captured, and where.
struct CaptureConfig {
    std::filesystem::path file{"bus.pcapng.gz"};
    std::filesystem::path network_namespace; ///< in which the interfaces are; empty: the process's own
    struct Port {
        std::string name;        ///< in the file: "process_bus/mu21"
        std::string description; ///< in the file, for people
        std::string interface;   ///< network interface
        std::string host;        ///< in whose network it is, by GRIDSPACE_NETWORKS; empty: in network_namespace
        std::string
            link; ///< incoming frames as the ledgers call them; empty: they have none, and lockstep passes them over
        bool both_ways{false}; ///< outgoing frames too
        std::string link_out;  ///< these in the ledgers
    };
    std::vector<Port> ports;
};

struct RecorderConfig {
    std::filesystem::path file{"data.mcap"};
    struct Topic {
        std::string name;
        std::string type;
        std::filesystem::path idl; ///< of a type that is not ours
    };
    std::vector<Topic> topics;
    bool compress{true};
    CaptureConfig capture;
};

/// Its configuration file.
void describe(config::Fields& f, RecorderConfig& config);

/// What a scenario may say about it; the rest is filled in by `gridspace run`.
void describe_own(config::Fields& f, RecorderConfig& config);
[[nodiscard]] program::Declaration recorder_declaration();

} // namespace gridspace::recorder
