// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/export/data_set.hpp"

namespace gridspace::dataset {

/// README.md of a data set: what it is, how it was made, its columns, its licence, and what repeats it.
[[nodiscard]] std::string data_card(DataSet const& data, DataSetOptions const& options);

} // namespace gridspace::dataset
