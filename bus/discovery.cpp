// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/discovery_impl.hpp"

#include <algorithm>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

namespace gridspace::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

double seconds_of(eprosima::fastrtps::Duration_t const& duration) {
    return duration == eprosima::fastrtps::c_TimeInfinite ? -1 : static_cast<double>(duration.to_ns()) * 1e-9;
}

/// None announced: XCDR1 (DDS-XTypes 1.3, 7.6.3.1.1). What the specification does not name is left out.
std::vector<Representation> representations_of(dds::DataRepresentationQosPolicy const& policy) {
    std::vector<Representation> out;
    for (auto const id : policy.m_value) {
        if (id >= dds::XCDR_DATA_REPRESENTATION && id <= dds::XCDR2_DATA_REPRESENTATION) {
            out.push_back(static_cast<Representation>(id));
        }
    }
    return out.empty() ? std::vector{Representation::xcdr1} : out;
}

template <class Data>
DiscoveredEndpoint from(Data const& data, bool writer) {
    DiscoveredEndpoint out;
    out.id = id_of(data.guid());
    out.participant = id_of(data.guid().guidPrefix);
    out.topic = std::string{data.topicName().c_str()};
    out.type = std::string{data.typeName().c_str()};
    out.writer = writer;
    out.keyed = data.topicKind() == rtps::WITH_KEY;
    out.qos.reliable = data.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
    out.qos.durability = static_cast<Durability>(data.m_qos.m_durability.kind);
    out.qos.deadline_s = seconds_of(data.m_qos.m_deadline.period);
    out.qos.liveliness = static_cast<Liveliness>(data.m_qos.m_liveliness.kind);
    out.qos.lease_s = seconds_of(data.m_qos.m_liveliness.lease_duration);
    out.qos.exclusive = data.m_qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS;
    out.qos.partitions = data.m_qos.m_partition.getNames();
    out.qos.scope = static_cast<PresentationScope>(data.m_qos.m_presentation.access_scope);
    out.qos.coherent = data.m_qos.m_presentation.coherent_access;
    out.qos.ordered = data.m_qos.m_presentation.ordered_access;
    out.qos.by_source_timestamp = data.m_qos.m_destinationOrder.kind == dds::BY_SOURCE_TIMESTAMP_DESTINATIONORDER_QOS;
    out.qos.representations = representations_of(data.m_qos.representation);
    out.qos.latency_budget_s = seconds_of(data.m_qos.m_latencyBudget.duration);
    return out;
}

// The numbers of the DDS specification, on which the casts above rely.
static_assert(static_cast<int>(dds::VOLATILE_DURABILITY_QOS) == static_cast<int>(Durability::volatile_));
static_assert(static_cast<int>(dds::PERSISTENT_DURABILITY_QOS) == static_cast<int>(Durability::persistent));
static_assert(static_cast<int>(dds::AUTOMATIC_LIVELINESS_QOS) == static_cast<int>(Liveliness::automatic));
static_assert(static_cast<int>(dds::MANUAL_BY_TOPIC_LIVELINESS_QOS) == static_cast<int>(Liveliness::manual_by_topic));
static_assert(static_cast<int>(dds::GROUP_PRESENTATION_QOS) == static_cast<int>(PresentationScope::group));
static_assert(static_cast<int>(dds::XCDR2_DATA_REPRESENTATION) == static_cast<int>(Representation::xcdr2));

} // namespace

std::string id_of(rtps::GuidPrefix_t const& prefix) {
    std::string out;
    for (rtps::octet const octet : prefix.value) {
        out += fmt::format("{:02x}", octet);
    }
    return out;
}

std::string id_of(rtps::GUID_t const& guid) {
    std::string out = id_of(guid.guidPrefix);
    for (rtps::octet const octet : guid.entityId.value) {
        out += fmt::format("{:02x}", octet);
    }
    return out;
}

std::vector<std::string> addresses_of(rtps::ParticipantProxyData const& data) {
    std::vector<std::string> out;
    for (rtps::Locator_t const& locator : data.default_locators.unicast) {
        if (locator.kind == LOCATOR_KIND_UDPv4) {
            std::string address = rtps::IPLocator::ip_to_string(locator);
            if (std::find(out.begin(), out.end(), address) == out.end()) {
                out.push_back(std::move(address));
            }
        }
    }
    return out;
}

DiscoveredEndpoint endpoint_of(rtps::WriterProxyData const& data, bool writer) {
    return from(data, writer);
}
DiscoveredEndpoint endpoint_of(rtps::ReaderProxyData const& data, bool writer) {
    return from(data, writer);
}

} // namespace gridspace::bus
