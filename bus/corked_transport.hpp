// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

namespace gridspace::bus {

/// Any transport with bus/cork.hpp on its sending side. Receivers need nothing: several submessages in a message are
/// plain RTPS (DDSI-RTPS 2.2, clause 8.3).
struct CorkedTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
    using ChainingTransportDescriptor::ChainingTransportDescriptor;
    [[nodiscard]] eprosima::fastdds::rtps::TransportInterface* create_transport() const override;
};

} // namespace gridspace::bus
