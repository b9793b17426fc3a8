// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::recorder {

/// Settings of gridspace-recorder.
struct RecorderConfig {
    std::filesystem::path file{"data.mcap"};
    struct Topic {
        std::string name;
        std::string type;
        std::filesystem::path idl; ///< of a type that is not ours
    };
    std::vector<Topic> topics;
    bool compress{true};
};

void describe(config::Fields& f, RecorderConfig& config);

} // namespace gridspace::recorder
