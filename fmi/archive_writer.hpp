// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>
#include <vector>

namespace gridspace::fmi {

struct ArchiveFile {
    std::string name; ///< in the archive, with '/'
    std::string content;
};

/// A zip file of these, deflated, in this order. The same files give the same octets: nothing of the clock, the user
/// or the machine is in it.
[[nodiscard]] Result<std::string> make_archive(std::vector<ArchiveFile> const& files);

} // namespace gridspace::fmi
