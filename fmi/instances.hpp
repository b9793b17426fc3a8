// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/shared_object.hpp"

namespace gridspace::fmi {

/// Instances of the two versions. `resources`: the folder in the shape that the version wants, a URI or a path.
[[nodiscard]] Result<std::unique_ptr<Instance>> make_instance2(SharedObject object, ModelDescription const& description,
                                                               std::string const& resources, std::string const& name,
                                                               Host& host);
[[nodiscard]] Result<std::unique_ptr<Instance>> make_instance3(SharedObject object, ModelDescription const& description,
                                                               std::string const& resources, std::string const& name,
                                                               Host& host);
/// The functions that were looked for are all there.
[[nodiscard]] Result<void> complain_of_missing(SharedObject const& object, ModelDescription const& description);

} // namespace gridspace::fmi
