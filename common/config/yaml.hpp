// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>

namespace gridspace::config {

// What may be read at most, so that a file of a stranger costs no more than one of its size. Each is an error that
// names the limit.
inline constexpr std::size_t kMaxYamlOctets = 16U << 20U; ///< of a file
inline constexpr std::size_t kMaxYamlDepth = 64;          ///< of lists and maps in each other
inline constexpr std::size_t kMaxYamlValues = 500'000;    ///< in a text, and in place of `like`
inline constexpr std::size_t kMaxYamlCopies = 100'000;    ///< values under anchors and in place of aliases

/// Reads YAML text into a tree. Duplicate keys, syntax errors, several documents and non-text keys are errors;
/// yaml-cpp accepts the first of these silently, so the tree is built from its parse events.
/// Returns nothing when the text cannot be read at all; otherwise check `diagnostics`.
[[nodiscard]] std::optional<Node> parse_yaml(std::string_view text, std::shared_ptr<SourceText const> source,
                                             Diagnostics& diagnostics);

/// Reads a file. `named_at` is where its name was written (for "no such file"); a default mark for a command-line name.
[[nodiscard]] std::optional<Node> load_yaml(std::filesystem::path const& file, Diagnostics& diagnostics,
                                            SourceMark named_at = {});

/// A source for text that is not a file, e.g. "--set #1".
[[nodiscard]] std::shared_ptr<SourceText const> make_source(std::string name, std::string_view text,
                                                            std::string directory = ".");

} // namespace gridspace::config
