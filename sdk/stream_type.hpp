// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/gateway_config.hpp"
#include "gateways/streams/stream.hpp"

#include <string>

namespace gridspace::sdk {

/// A stream as a topic: the struct that its samples or messages are for a program, and the mapping between the two.
/// Members: `time_ns`; of a stream that is read `alive` (false: it has fallen silent), `smp_cnt` and `smp_synch` or
/// `st_num` and `sq_num`; then the data set in its order, with '_' for what is no letter or digit ("mag.f" is mag_f).
/// Bit strings have no member.
struct StreamType {
    std::string name; ///< of the struct: Stream_NAME
    std::string idl;
    gateways::MappingConfig mapping;
};

[[nodiscard]] StreamType type_of_read(streams::Stream const& stream);
[[nodiscard]] StreamType type_of_written(streams::Stream const& stream);

} // namespace gridspace::sdk
