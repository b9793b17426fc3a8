// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/raw_access.hpp"

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

namespace gridspace::bus {

/// Replaces the transports of a participant by the link.
[[nodiscard]] Result<void> apply(TcpLink const& link, eprosima::fastdds::dds::DomainParticipantQos& qos);
void apply(EndpointQos const& like, eprosima::fastdds::dds::DataReaderQos& qos);
void apply(EndpointQos const& like, std::int32_t depth, eprosima::fastdds::dds::DataWriterQos& qos);

} // namespace gridspace::bus
