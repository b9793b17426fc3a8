// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/gate.hpp"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::bus {

/// Any transport with bus/send_together.hpp on its sending side and the gate of bus/rtps_guard on its receiving side.
/// Receivers need nothing for the cork: several submessages in a message are plain RTPS (DDSI-RTPS 2.2, clause 8.3).
struct CorkedTransportDescriptor : eprosima::fastdds::rtps::ChainingTransportDescriptor {
    CorkedTransportDescriptor(std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> low_level,
                              std::shared_ptr<rtps_guard::Gate> g)
        : ChainingTransportDescriptor{std::move(low_level)}, gate{std::move(g)} {}
    std::shared_ptr<rtps_guard::Gate> gate;
    /// By UDP, on these interfaces (IPv4 addresses), with a kernel buffer of so many octets: the process's Receiving
    /// hears, and not a thread of the library's for each socket. Empty: the library does.
    std::vector<std::string> interfaces;
    std::uint32_t receive_buffer{0};
    [[nodiscard]] eprosima::fastdds::rtps::TransportInterface* create_transport() const override;
};

} // namespace gridspace::bus
