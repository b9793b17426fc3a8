// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/forecaster/model.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace gridspace::ids {

/// SHA-256 (hex) of what a model computes: its scalars as text, then weights and biases as little-endian doubles
/// (docs/reference/ids.md says how to check it with ten lines of Python). Name and provenance are not part of it.
[[nodiscard]] std::string model_hash(Model const& model);

/// The model as JSON, with its hash. Reads back to the same model, bit by bit.
[[nodiscard]] std::string to_json(Model const& model);

/// Reads what to_json wrote. Damaged text, unknown fields, wrong sizes, numbers that are not finite and a hash that
/// does not fit are errors that name the field; `source` is what the text came from.
[[nodiscard]] Result<Model> model_from_json(std::string_view text, std::string const& source);

[[nodiscard]] Result<Model> load_model(std::filesystem::path const& file);
[[nodiscard]] Result<void> save_model(Model const& model, std::filesystem::path const& file);

} // namespace gridspace::ids
