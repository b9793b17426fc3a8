// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "common/result.hpp"

#include <string>
#include <vector>

namespace gridspace::scl {

struct ImportOptions {
    std::string ied;       ///< empty: all
    double nominal_hz{50}; ///< for rates that are given per period
};

struct Import {
    config::Node streams;           ///< a `streams:` map, by "<IED>_<control block>"
    std::vector<std::string> notes; ///< what was left out or assumed, with the line
};

/// Reads the GOOSE and SMV control blocks of an SCL file (SCD, ICD, CID, IID; any edition, any prefix). Liberal: a
/// control block that cannot be read is left out and noted. Fails when the file is no SCL or the IED is not in it.
[[nodiscard]] Result<Import> import_streams(std::string const& text, std::string const& name,
                                            ImportOptions const& options);

} // namespace gridspace::scl
