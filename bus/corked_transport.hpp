// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/gate.hpp"

#include <atomic>
#include <cstdint>
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
    /// Set to the port on which it hears samples by unicast: the odd one of a participant (DDSI-RTPS 2.2, clause
    /// 9.6.1.1: domain and participant gains are even, d1 is 10 and d3 is 11). 0: not open yet.
    std::shared_ptr<std::atomic<std::uint16_t>> samples_port;
    [[nodiscard]] eprosima::fastdds::rtps::TransportInterface* create_transport() const override;
};

} // namespace gridspace::bus
