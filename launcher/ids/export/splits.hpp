// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gridspace::dataset {

/// "train", "validation" or "test" for each run: all runs of a group are in the same one, so that what is tested was
/// never trained on. `groups`: of each run, what it must not share with another part (grids, kinds of attack); runs
/// that share one belong together, also by way of a third. A run without any is a group of its own.
///
/// Groups are drawn by the seed in an order that depends on nothing else than their names. Of three groups or more each
/// part has at least one, and about 60, 20 and 20 % of the groups; of two, train and test have one each; of one, train.
[[nodiscard]] std::vector<std::string> split(std::vector<std::vector<std::string>> const& groups,
                                             std::vector<std::string> const& ids, std::uint64_t seed);

} // namespace gridspace::dataset
