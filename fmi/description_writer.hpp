// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/model_description.hpp"

namespace gridspace::fmi {

/// modelDescription.xml of an FMU of version 3.0 for co-simulation (sections 2.4 and 4.4 of FMI 3.0.1): variables in
/// the order of the list, their units, every output in the structure of the model. Outputs follow inputs with the next
/// step, so that they depend on none at a communication point. Values of type float64, boolean and
/// enumeration, each of which has a type of its own.
[[nodiscard]] std::string write_model_description(ModelDescription const& description);

} // namespace gridspace::fmi
