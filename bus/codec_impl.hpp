// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"

#include <cstring>
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>
#include <fastdds/rtps/common/InstanceHandle.h>

namespace gridspace::bus::detail {

/// A Codec from what fastddsgen made: the struct T and its PubSubType.
template <class T, class PubSubType>
Codec make_codec(std::string_view name) {
    static PubSubType type;
    Codec codec;
    codec.type_name = name;
    codec.keyed = type.m_isGetKeyDefined;
    codec.max_size = type.m_typeSize;
    codec.encode = [](void const* sample, std::span<std::byte> out) -> std::size_t {
        try {
            eprosima::fastcdr::FastBuffer buffer{reinterpret_cast<char*>(out.data()), out.size()};
            eprosima::fastcdr::Cdr cdr{buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                                       eprosima::fastcdr::Cdr::DDS_CDR};
            cdr.serialize_encapsulation();
            static_cast<T const*>(sample)->serialize(cdr);
            return cdr.getSerializedDataLength();
        } catch (eprosima::fastcdr::exception::Exception const&) {
            return 0;
        }
    };
    codec.decode = [](std::span<std::byte const> in, void* sample) -> bool {
        try {
            // FastBuffer takes a mutable pointer and only reads here.
            eprosima::fastcdr::FastBuffer buffer{const_cast<char*>(reinterpret_cast<char const*>(in.data())),
                                                 in.size()};
            eprosima::fastcdr::Cdr cdr{buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::Cdr::DDS_CDR};
            cdr.read_encapsulation();
            static_cast<T*>(sample)->deserialize(cdr);
            return true;
        } catch (std::exception const&) {
            return false;
        }
    };
    codec.encoded_size = [](void const* sample) -> std::size_t {
        return T::getCdrSerializedSize(*static_cast<T const*>(sample)) + 4;
    };
    codec.key = [](void const* sample, std::array<std::uint8_t, 16>& key_hash) {
        eprosima::fastrtps::rtps::InstanceHandle_t handle;
        type.getKey(const_cast<void*>(sample), &handle, false);
        for (std::size_t i = 0; i < key_hash.size(); ++i) {
            key_hash[i] = handle.value[i];
        }
    };
    return codec;
}

} // namespace gridspace::bus::detail

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): a specialisation per generated type, named once
#define GRIDSPACE_CODEC(Type)                                                                                          \
    template <>                                                                                                        \
    gridspace::bus::Codec const& gridspace::bus::codec_of<Type>() {                                                    \
        static Codec const codec = detail::make_codec<Type, Type##PubSubType>(#Type);                                  \
        return codec;                                                                                                  \
    }
