// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/scl_file.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::cli {

Result<scl::Import> read_scl_file(std::filesystem::path const& file, scl::ImportOptions const& options) {
    std::error_code ignored;
    std::ifstream stream{file, std::ios::binary};
    if (!stream || std::filesystem::is_directory(file, ignored)) {
        return fail(ExitCode::usage, fmt::format("cannot read '{}'", file.string()),
                    stream ? "it is a folder; expected an SCD, ICD or CID file" : "expected an SCD, ICD or CID file");
    }
    auto imported = scl::import_streams({std::istreambuf_iterator<char>{stream}, {}}, file.string(), options);
    for (std::size_t i = 0; imported && i < imported->notes.size(); ++i) {
        fmt::print(stderr, "note: {}: {}\n", file.string(), imported->notes[i]);
    }
    return imported;
}

} // namespace gridspace::cli
