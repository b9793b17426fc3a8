// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"
#include "bus/key_hash.hpp"

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

namespace gridspace::bus {

/// Fast DDS passes samples as void*; this first member shows which of the two it is.
enum class Direction : std::uint8_t { outgoing, incoming };

/// What a writer hands to Fast DDS: a sample with the codec that encodes it, or ready CDR.
struct Outgoing {
    Direction direction{Direction::outgoing};
    Codec const* codec{nullptr};
    void const* sample{nullptr};
    std::span<std::byte const> cdr;
    KeyHash const* key_hash{nullptr}; ///< of ready CDR
};

/// What a reader gets from Fast DDS: the CDR as it was sent.
struct Incoming {
    Direction direction{Direction::incoming};
    std::vector<std::byte> cdr;
};

/// The one data type that Fast DDS knows here: octets. Readers and writers match by topic and type name, so this
/// carries every type, known at compile time or not, and no type object is ever announced (other 2.9.1 participants
/// crash on it).
class PayloadType final : public eprosima::fastdds::dds::TopicDataType {
  public:
    explicit PayloadType(Codec const& codec);
    bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
    bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
    std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
    void* createData() override;
    void deleteData(void* data) override;
    bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override;
};

} // namespace gridspace::bus
