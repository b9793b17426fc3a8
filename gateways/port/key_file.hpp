// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/streams/stream_authentication.hpp"

#include <optional>

namespace gridspace::gateways {

/// The keys of a stream: of its file, which nobody but its owner may read or write, or the one of its name.
/// `start_utc_ns`: when simulated time is 0, where that is known beforehand.
[[nodiscard]] Result<std::vector<iec61850::KeyEntry>> load_keys(streams::StreamAuthentication const& authentication,
                                                                std::optional<std::int64_t> start_utc_ns);

} // namespace gridspace::gateways
