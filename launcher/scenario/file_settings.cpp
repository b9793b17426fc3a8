// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/file_settings.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using config::Key;
using config::Node;

fs::path whole_path(Node const& written) {
    std::string const base = written.where.source == nullptr ? "." : written.where.source->directory;
    return fs::absolute(fs::path{base} / written.text).lexically_normal();
}

/// Calls `visit` for each file that is written. What is written wrongly was said when the keys were read.
template <class N, class Visit>
void for_each_file(N& settings, std::vector<Key> const& keys, Visit const& visit) {
    for (Key const& key : keys) {
        auto* const node = settings.find(key.key);
        if (node == nullptr) {
            continue;
        }
        switch (key.kind) {
        case Key::Kind::file:
            if (node->is_scalar() && !node->is_null() && !node->text.empty()) {
                visit(key, *node);
            }
            break;
        case Key::Kind::object:
            for_each_file(*node, key.children, visit);
            break;
        case Key::Kind::map:
            for (auto& entry : node->entries) {
                for_each_file(entry.value, key.children, visit);
            }
            break;
        case Key::Kind::list:
            for (auto& item : node->items) {
                for_each_file(item, key.children, visit);
            }
            break;
        default:
            break;
        }
    }
}

} // namespace

void check_files(Node const& settings, std::vector<Key> const& keys, config::Diagnostics& diagnostics) {
    for_each_file(settings, keys, [&](Key const& key, Node const& written) {
        fs::path const path = whole_path(written);
        std::error_code failed;
        fs::file_status const status = fs::status(path, failed);
        if (fs::exists(status) && !fs::is_directory(status)) {
            return;
        }
        diagnostics.error(written.where,
                          fmt::format("'{}' names '{}', which {}", key.key, path.string(),
                                      fs::is_directory(status) ? "is a folder" : "does not exist"),
                          "expected a file; a path is relative to the file in which it is written",
                          static_cast<int>(written.text.size()) + (written.quoted ? 2 : 0));
    });
}

void resolve_files(Node& settings, std::vector<Key> const& keys) {
    for_each_file(settings, keys,
                  [](Key const&, Node& written) { written = Node::quoted_text(whole_path(written).string()); });
}

} // namespace gridspace::launcher
