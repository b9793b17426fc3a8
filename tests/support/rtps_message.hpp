// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace gridspace::test {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& to, Bytes const& what) {
    to.insert(to.end(), what.begin(), what.end());
}
/// `value` in so many octets, the lowest first.
inline Bytes little(std::uint64_t value, std::size_t octets) {
    Bytes out;
    for (std::size_t i = 0; i < octets; ++i) {
        out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return out;
}
inline Bytes entity(std::uint32_t id) {
    Bytes out = little(id, 4);
    return {out.rbegin(), out.rend()};
}
/// A sequence number: high word, low word.
inline Bytes number(std::int64_t value) {
    Bytes out = little(static_cast<std::uint64_t>(value) >> 32U, 4);
    append(out, little(static_cast<std::uint64_t>(value), 4));
    return out;
}
inline Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes out;
    for (Bytes const& part : parts) {
        append(out, part);
    }
    return out;
}
inline Bytes guid_prefix(std::uint8_t last) {
    return {1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, last};
}

inline Bytes parameter(std::uint16_t pid, Bytes value) {
    value.resize((value.size() + 3) / 4 * 4);
    return joined({little(pid, 2), little(value.size(), 2), value});
}
inline Bytes text(std::string_view characters) {
    Bytes out = little(characters.size() + 1, 4);
    out.insert(out.end(), characters.begin(), characters.end());
    out.push_back(0);
    return out;
}
inline Bytes const kSentinel{1, 0, 0, 0};

/// A submessage of DDSI-RTPS, little endian.
inline Bytes submessage(std::uint8_t kind, Bytes const& body, std::uint8_t flags = 1) {
    return joined({{kind, flags}, little(body.size(), 2), body});
}
/// A message of the participant whose prefix ends in `source`.
inline Bytes message(std::initializer_list<Bytes> submessages, std::uint8_t source = 1) {
    Bytes out = joined({{'R', 'T', 'P', 'S', 2, 2, 1, 15}, guid_prefix(source)});
    for (Bytes const& s : submessages) {
        append(out, s);
    }
    return out;
}
/// DATA with a payload, from writer to reader.
inline Bytes data(std::uint32_t reader, std::uint32_t writer, Bytes const& payload, std::int64_t sequence = 1,
                  std::uint8_t flags = 5) {
    return submessage(0x15, joined({{0, 0, 16, 0}, entity(reader), entity(writer), number(sequence), payload}), flags);
}
inline constexpr std::uint32_t kParticipantWriter = 0x000100c2, kParticipantReader = 0x000100c7;
/// "Here is the participant `who`", with more parameters.
inline Bytes announcement(std::uint8_t who, Bytes const& more = {}, std::string_view name = "stranger") {
    Bytes const guid = joined({guid_prefix(who), entity(0x000001c1)});
    Bytes const at = joined({little(1, 4), little(9, 4), Bytes(12), {127, 0, 0, 1}}); // UDPv4, where nobody listens
    return data(kParticipantReader, kParticipantWriter,
                joined({{0, 3, 0, 0},
                        parameter(0x0015, {2, 2}),
                        parameter(0x0016, {1, 15}),
                        parameter(0x0050, guid),
                        parameter(0x0032, at),
                        parameter(0x0002, little(100, 8)),
                        parameter(0x0062, text(name)),
                        more,
                        kSentinel}));
}
inline constexpr std::uint32_t kPublicationsWriter = 0x000003c2, kSubscriptionsWriter = 0x000004c2;
/// "I have this reader or writer", as the `sequence`th word of the participant `who`. Both are reliable.
inline Bytes endpoint(std::uint8_t who, std::uint32_t id, std::string_view topic, std::string_view type,
                      std::int64_t sequence) {
    bool const is_writer = (id & 0x3fU) == 2 || (id & 0x3fU) == 3;
    std::uint32_t const writer = is_writer ? kPublicationsWriter : kSubscriptionsWriter;
    Bytes const guid = joined({guid_prefix(who), entity(id)});
    Bytes const at = joined({little(1, 4), little(9, 4), Bytes(12), {127, 0, 0, 1}});
    return data(writer + 5, writer,
                joined({{0, 3, 0, 0},
                        parameter(0x005a, guid),
                        parameter(0x0050, joined({guid_prefix(who), entity(0x000001c1)})),
                        parameter(0x002f, at),
                        parameter(0x0005, text(topic)),
                        parameter(0x0007, text(type)),
                        parameter(0x001a, joined({little(2, 4), Bytes(8)})),
                        kSentinel}),
                sequence);
}
inline Bytes const kStatistics = submessage(0x80, Bytes(56));

/// What ended a process of Debian's Fast DDS 2.9.1: its statistics, and something behind them. 92 octets.
inline Bytes deadly_datagram() {
    return message({kStatistics, submessage(0x09, Bytes(8))});
}

} // namespace gridspace::test
