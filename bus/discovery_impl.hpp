// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

namespace gridspace::bus {

/// What Fast DDS reports about others, in our terms.
[[nodiscard]] std::string id_of(eprosima::fastrtps::rtps::GuidPrefix_t const& prefix);
[[nodiscard]] std::string id_of(eprosima::fastrtps::rtps::GUID_t const& guid);
[[nodiscard]] std::vector<std::string> addresses_of(eprosima::fastrtps::rtps::ParticipantProxyData const& data);
[[nodiscard]] DiscoveredEndpoint endpoint_of(eprosima::fastrtps::rtps::WriterProxyData const& data, bool writer);
[[nodiscard]] DiscoveredEndpoint endpoint_of(eprosima::fastrtps::rtps::ReaderProxyData const& data, bool writer);

} // namespace gridspace::bus
