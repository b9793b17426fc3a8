// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/fastdds_type.hpp"

#include <cstring>

namespace gridspace::bus {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

/// A plain submessage is filled up to four octets on the wire, and so arrives. An encrypted sample is not, and of a
/// signed one the library then counts what was filled up as signed (2.9.1). So samples are whole words from the start.
constexpr std::uint32_t in_whole_words(std::size_t octets) {
    return static_cast<std::uint32_t>((octets + 3) / 4 * 4);
}

} // namespace

PayloadType::PayloadType(Codec const& codec) {
    setName(std::string{codec.type_name}.c_str());
    m_typeSize = codec.max_size != 0 ? in_whole_words(codec.max_size) : 4096;
    m_isGetKeyDefined = codec.keyed;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
}

bool PayloadType::serialize(void* data, rtps::SerializedPayload_t* payload) {
    auto const* out = static_cast<Outgoing const*>(data);
    if (out->sample == nullptr) {
        payload->length = in_whole_words(out->cdr.size());
        if (payload->max_size < payload->length || out->cdr.size() < 4) {
            return false;
        }
        std::memcpy(payload->data, out->cdr.data(), out->cdr.size());
        std::memset(payload->data + out->cdr.size(), 0, payload->length - out->cdr.size());
    } else {
        // The CDR library skips padding octets; what stood in the pool would go onto the wire, and runs would differ.
        std::memset(payload->data, 0,
                    std::min(payload->max_size, in_whole_words(out->codec->encoded_size(out->sample))));
        std::size_t const used =
            out->codec->encode(out->sample, {reinterpret_cast<std::byte*>(payload->data), payload->max_size});
        if (used == 0) {
            return false;
        }
        payload->length = std::min(in_whole_words(used), payload->max_size);
    }
    payload->encapsulation = payload->data[1] == 0 ? CDR_BE : CDR_LE;
    return true;
}

bool PayloadType::deserialize(rtps::SerializedPayload_t* payload, void* data) {
    auto const* octets = reinterpret_cast<std::byte const*>(payload->data);
    static_cast<Incoming*>(data)->cdr.assign(octets, octets + payload->length);
    return true;
}

std::function<std::uint32_t()> PayloadType::getSerializedSizeProvider(void* data) {
    auto const* out = static_cast<Outgoing const*>(data);
    return [out] {
        return in_whole_words(out->sample != nullptr ? out->codec->encoded_size(out->sample) : out->cdr.size());
    };
}

void* PayloadType::createData() {
    return new Incoming;
}
void PayloadType::deleteData(void* data) {
    delete static_cast<Incoming*>(data);
}

bool PayloadType::getKey(void* data, rtps::InstanceHandle_t* handle, bool) {
    if (!m_isGetKeyDefined) {
        return false;
    }
    std::array<std::uint8_t, 16> key{};
    key[15] = 1;
    auto const* out = static_cast<Outgoing const*>(data);
    // A reader does not tell keys apart here: one instance, in a history that is deep enough for all of them.
    if (out->direction == Direction::outgoing && out->sample != nullptr && out->codec->key != nullptr) {
        out->codec->key(out->sample, key);
    } else if (out->direction == Direction::outgoing && out->key_hash != nullptr) {
        key = *out->key_hash;
    }
    std::memcpy(handle->value, key.data(), key.size());
    return true;
}

} // namespace gridspace::bus
