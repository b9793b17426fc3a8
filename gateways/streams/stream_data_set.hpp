// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/streams/stream.hpp"

namespace gridspace::streams {

/// The key `data_set` of a stream: members and their types, or 9-2LE.
void describe_data_set(config::Fields& f, Stream& stream);

} // namespace gridspace::streams
