// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/fmu/network_files.hpp"

#include "common/config/merge.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using config::Node;

std::optional<std::string> content_of(fs::path const& file, config::SourceMark const& named_at,
                                      config::Diagnostics& diagnostics) {
    std::ifstream in{file, std::ios::binary};
    std::string text{std::istreambuf_iterator<char>{in}, {}};
    if (!in) {
        diagnostics.error(named_at, fmt::format("cannot read '{}'", file.string()));
        return std::nullopt;
    }
    return text;
}

/// Puts the files that profiles name next to the network, each once, and their new names into the tree.
bool take_profiles(Node& root, std::vector<fmi::ArchiveFile>& files, config::Diagnostics& diagnostics) {
    std::map<std::string, std::string> taken; // file -> its name here
    Node* const profiles = root.find("profiles");
    for (std::size_t i = 0; profiles != nullptr && i < profiles->entries.size(); ++i) {
        Node::Entry& profile = profiles->entries[i];
        Node* const csv = profile.value.find("csv");
        if (csv == nullptr) {
            continue;
        }
        fs::path const folder = csv->where.source == nullptr ? "." : csv->where.source->directory;
        std::string const file = (folder / csv->text).lexically_normal().string();
        auto const [known, fresh] = taken.try_emplace(file, fmt::format("profile_{}.csv", profile.key));
        if (fresh) {
            auto content = content_of(file, csv->where, diagnostics);
            if (!content) {
                return false;
            }
            files.push_back({known->second, std::move(*content)});
        }
        profile.value.set("csv", Node::quoted_text(known->second));
    }
    return true;
}

} // namespace

std::optional<std::vector<fmi::ArchiveFile>> network_files(fs::path const& network, config::Diagnostics& diagnostics) {
    std::vector<fmi::ArchiveFile> files;
    if (network.extension() == ".m") {
        auto content = content_of(network, {}, diagnostics);
        return content ? std::optional{std::vector{fmi::ArchiveFile{"network.m", std::move(*content)}}} : std::nullopt;
    }
    auto root = config::load_extended(network, diagnostics);
    files.push_back({"network.yaml", ""});
    if (!root || !take_profiles(*root, files, diagnostics)) {
        return std::nullopt;
    }
    files.front().content = config::to_yaml(*root);
    return files;
}

} // namespace gridspace::launcher
