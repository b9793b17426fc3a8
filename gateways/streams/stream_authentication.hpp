// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "gateways/iec61850/authentication_key.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace gridspace::streams {

/// How the frames of a stream are authenticated (gateways/iec61850/authentication.hpp).
struct StreamAuthentication {
    std::filesystem::path key_file; ///< of mode 0600; its content is never copied anywhere
    std::string key_name;           ///< instead: a key that everybody can compute, for studies
    iec61850::CodeAlgorithm algorithm{iec61850::CodeAlgorithm::hmac_sha256_128};
    bool required{false}; ///< subscribers refuse what is not genuine; otherwise they report it
    double max_age_ms{2000};
};

/// The key `authentication`.
void describe(config::Fields& f, std::optional<StreamAuthentication>& authentication);

} // namespace gridspace::streams
