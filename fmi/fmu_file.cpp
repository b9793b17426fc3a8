// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Where in the zip file of an FMU its description and its binaries are.
#include "common/text.hpp"
#include "fmi/archive.hpp"
#include "fmi/model_description.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::fmi {
namespace {

constexpr std::uint64_t kLongestDescription = std::uint64_t{64} << 20U;

/// FMI 3.0 names processor and system; FMI 2.0 knew only "linux64", and others took the names of 3.0.
std::vector<std::string> folders_of_this_machine(Version version) {
#if defined(__x86_64__)
    return version == Version::fmi2 ? std::vector<std::string>{"linux64", "x86_64-linux"}
                                    : std::vector<std::string>{"x86_64-linux"};
#elif defined(__aarch64__)
    (void)version;
    return {"aarch64-linux"};
#else
    (void)version;
    return {};
#endif
}

} // namespace

Result<ModelDescription> read_model_description(Archive const& archive, std::string const& file) {
    auto const xml = archive.read("modelDescription.xml", kLongestDescription);
    if (!xml) {
        return std::unexpected{xml.error()};
    }
    return parse_model_description(*xml, file);
}

std::vector<std::string> platforms(Archive const& archive) {
    constexpr std::string_view kFolder = "binaries/";
    std::vector<std::string> out;
    for (Archive::Entry const& entry : archive.entries()) {
        std::string_view const rest = std::string_view{entry.name}.starts_with(kFolder)
                                          ? std::string_view{entry.name}.substr(kFolder.size())
                                          : std::string_view{};
        std::size_t const slash = rest.find('/');
        if (slash != std::string_view::npos && slash + 1 < rest.size() &&
            std::find(out.begin(), out.end(), rest.substr(0, slash)) == out.end()) {
            out.emplace_back(rest.substr(0, slash));
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

Result<std::string> binary_of(Archive const& archive, ModelDescription const& description) {
    auto const usable = description.usable();
    if (!usable) {
        return std::unexpected{usable.error()};
    }
    std::vector<std::string> const folders = folders_of_this_machine(description.version);
    for (std::string const& folder : folders) {
        std::string name = fmt::format("binaries/{}/{}.so", folder, usable->identifier);
        if (archive.has(name)) {
            return name;
        }
    }
    std::vector<std::string> const there = platforms(archive);
    bool const other_name = std::any_of(folders.begin(), folders.end(), [&](std::string const& folder) {
        return std::find(there.begin(), there.end(), folder) != there.end();
    });
    std::string const wanted =
        fmt::format("binaries/{}/{}.so", folders.empty() ? "?" : folders.front(), usable->identifier);
    return fail(ExitCode::usage,
                fmt::format("{}: it has no binary for this machine, '{}'; it has {}", description.file, wanted,
                            there.empty() ? "none at all" : "some for " + join(there, ", ")),
                other_name ? "its binary has another name than its modelIdentifier: export it again"
                           : "export it for 64-bit Linux, or compile its sources");
}

} // namespace gridspace::fmi
