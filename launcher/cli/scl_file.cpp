// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/scl_file.hpp"

#include <fmt/format.h>
#include <fstream>
#include <vector>

namespace gridspace::cli {

Result<std::string> read_whole_scl_file(std::filesystem::path const& file) {
    std::error_code ignored;
    std::ifstream stream{file, std::ios::binary};
    if (!stream || std::filesystem::is_directory(file, ignored)) {
        return fail(ExitCode::usage, fmt::format("cannot read '{}'", file.string()),
                    stream ? "it is a folder; expected an SCD, ICD or CID file" : "expected an SCD, ICD or CID file");
    }
    std::string text;
    std::vector<char> part(1U << 20U);
    while (stream && text.size() <= scl::kLargestFile) { // of a file that is larger the reader says so
        stream.read(part.data(), static_cast<std::streamsize>(part.size()));
        text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
    }
    return text;
}

Result<scl::Import> read_scl_file(std::filesystem::path const& file, scl::ImportOptions const& options) {
    auto const text = read_whole_scl_file(file);
    auto imported =
        text ? scl::import_streams(*text, file.string(), options) : Result<scl::Import>{std::unexpected{text.error()}};
    for (std::size_t i = 0; imported && i < imported->findings.size(); ++i) {
        scl::Finding const& one = imported->findings[i];
        fmt::print(stderr, "{}: note: {}{}\n", one.where.to_string(), one.text,
                   one.remedy.empty() ? "" : "; " + one.remedy);
    }
    if (imported && imported->findings_dropped > 0) {
        fmt::print(stderr, "note: {} more are not shown\n", imported->findings_dropped);
    }
    return imported;
}

} // namespace gridspace::cli
