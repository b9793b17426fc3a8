// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/certify/certificate.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// The faults of all groups that share a listed value: those of a type, those on a line.
struct Share {
    std::string parameter, value;
    Proportion right; ///< tripped in time, or stayed, as asked
    std::vector<double> trip_ms;
};
/// A row for each listed value of what varies, in the order of the file. Runs that ended early count for nothing.
[[nodiscard]] std::vector<Share> breakdown(CertifyCase const& all, std::vector<GroupResult> const& groups);

} // namespace gridspace::launcher
