// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/routable.hpp"

#include "gateways/iec61850/ber.hpp"

#include <algorithm>

namespace gridspace::iec61850 {
namespace {

constexpr std::uint8_t kUnitData = 0x40;                        // of connectionless transport (ISO 8602)
constexpr std::uint8_t kGooseSession = 0xA1, kSvSession = 0xA2; // session identifiers
constexpr std::uint8_t kCommonHeader = 0x80, kSignature = 0x85; // parameter identifiers
constexpr std::uint8_t kGoosePayload = 0x81, kSvPayload = 0x82; // payload types
constexpr std::uint32_t kGooseApdu = 0x61, kSvApdu = 0x60;      // tags of the APDUs
constexpr std::size_t kFixedHeader = 21;  // behind the length of the common header, without the vector
constexpr std::size_t kPayloadHeader = 6; // type, simulation, APPID, length
constexpr std::uint16_t kIpv4 = 0x0800;
constexpr std::uint8_t kUdp = 17;
constexpr std::size_t kIpHeader = 20, kUdpHeader = 8;

/// Reads octet by octet, never beyond the end.
class Reader {
  public:
    explicit Reader(Octets octets) : octets_{octets} {}
    [[nodiscard]] std::size_t at() const noexcept { return at_; }
    [[nodiscard]] std::size_t left() const noexcept { return octets_.size() - at_; }
    [[nodiscard]] std::uint8_t peek() const noexcept { return left() == 0 ? 0 : octets_[at_]; }
    template <class T>
    [[nodiscard]] T take() noexcept { // the caller has looked at left()
        T const value = load_be<T>(octets_.data() + at_);
        at_ += sizeof(T);
        return value;
    }
    [[nodiscard]] Octets take_octets(std::size_t n) noexcept {
        Octets const out = octets_.subspan(at_, n);
        at_ += n;
        return out;
    }

  private:
    Octets octets_;
    std::size_t at_{0};
};

/// Session identifier, common header, security information.
Decoded<void> read_session(Reader& in, RoutableFrame& out) noexcept {
    if (in.left() >= 2 && in.peek() == 1) { // a transport header of one octet behind its length
        (void)in.take<std::uint8_t>();
        if (in.take<std::uint8_t>() != kUnitData) {
            return undecodable(Reason::bad_tag, in.at() - 1);
        }
    }
    if (in.left() < 4) {
        return undecodable(Reason::too_short, in.at());
    }
    auto const identifier = in.take<std::uint8_t>();
    if (identifier != kGooseSession && identifier != kSvSession) {
        return undecodable(Reason::bad_tag, in.at() - 1, identifier);
    }
    out.session.goose = identifier == kGooseSession;
    std::size_t const header = in.take<std::uint8_t>();
    std::size_t const end = in.at() + header;
    if (header < kFixedHeader + 2 || header > in.left()) {
        return undecodable(Reason::truncated, in.at() - 1, identifier);
    }
    if (in.take<std::uint8_t>() != kCommonHeader) {
        return undecodable(Reason::bad_tag, in.at() - 1);
    }
    std::size_t const common = in.take<std::uint8_t>();
    if (common + 2 > header || common < kFixedHeader) {
        return undecodable(Reason::truncated, in.at() - 1, kCommonHeader);
    }
    out.spdu_length = in.take<std::uint32_t>();
    out.session.spdu_number = in.take<std::uint32_t>();
    out.session.version = in.take<std::uint16_t>();
    out.session.time_of_current_key = in.take<std::uint32_t>();
    out.session.time_to_next_key = in.take<std::uint16_t>();
    out.session.key_id = in.take<std::uint32_t>();
    std::size_t const vector = in.take<std::uint8_t>();
    if (vector + kFixedHeader > common) {
        return undecodable(Reason::truncated, in.at() - 1, kCommonHeader);
    }
    out.session.initialisation_vector = in.take_octets(vector);
    (void)in.take_octets(end - in.at()); // what later editions put there
    return {};
}

Decoded<void> read_payload(Reader& in, RoutableFrame& out) noexcept {
    std::size_t const start = in.at();
    if (in.left() < kPayloadHeader) {
        return undecodable(Reason::truncated, start);
    }
    if (out.count == RoutableFrame::kMaxPayloads) {
        return undecodable(Reason::too_many, start);
    }
    auto const type = in.take<std::uint8_t>();
    if (type != kGoosePayload && type != kSvPayload) {
        return undecodable(Reason::bad_tag, start, type);
    }
    RoutablePayload payload;
    payload.goose = type == kGoosePayload;
    payload.simulated = in.take<std::uint8_t>() != 0;
    payload.app_id = in.take<std::uint16_t>();
    (void)in.take<std::uint16_t>(); // implementations disagree about what it counts: the APDU knows its own length
    std::size_t const apdu = in.at();
    Octets const rest = in.take_octets(in.left());
    BerCursor cursor{rest, static_cast<std::uint32_t>(apdu)};
    Tlv element;
    if (Reason const reason = cursor.next(element); reason != Reason::none) {
        return std::unexpected{element.error(reason)};
    }
    if (element.tag != (payload.goose ? kGooseApdu : kSvApdu)) {
        return std::unexpected{element.error(Reason::bad_tag)};
    }
    std::size_t const octets = element.value_offset - apdu + element.value.size();
    payload.apdu = rest.first(octets);
    out.payloads[out.count++] = payload;
    return {};
}

/// The one's complement sum of RFC 1071.
std::uint32_t sum_of(Octets octets, std::uint32_t sum = 0) {
    for (std::size_t i = 0; i < octets.size(); ++i) {
        sum += i % 2 == 0 ? unsigned{octets[i]} << 8U : unsigned{octets[i]};
    }
    return sum;
}
std::uint16_t checksum(std::uint32_t sum) {
    while (sum > 0xFFFF) {
        sum = (sum & 0xFFFFU) + (sum >> 16U);
    }
    return static_cast<std::uint16_t>(~sum);
}

} // namespace

Decoded<void> decode_routable(Octets datagram, RoutableFrame& out) noexcept {
    out = {};
    Reader in{datagram};
    if (auto const session = read_session(in, out); !session) {
        return session;
    }
    if (in.left() < 4) {
        return undecodable(Reason::truncated, in.at());
    }
    std::size_t const length = in.take<std::uint32_t>();
    if (length > in.left()) {
        return undecodable(Reason::truncated, in.at() - 4);
    }
    std::size_t const end = in.at() + length;
    Reader payloads{datagram.first(end)};
    (void)payloads.take_octets(in.at());
    while (payloads.left() > 0) {
        std::size_t const before = payloads.at(), count = out.count;
        if (auto const payload = read_payload(payloads, out); !payload) {
            return payload;
        }
        // It took all that is left to find the end of its APDU: the next one begins there.
        std::size_t const next = before + kPayloadHeader + out.payloads[count].apdu.size();
        payloads = Reader{datagram.first(end)};
        (void)payloads.take_octets(next);
    }
    if (out.count == 0) {
        return undecodable(Reason::missing_field, end);
    }
    (void)in.take_octets(length);
    if (in.left() >= 2 && in.peek() == kSignature) {
        (void)in.take<std::uint8_t>();
        std::size_t const octets = in.take<std::uint8_t>();
        if (octets > in.left()) {
            return undecodable(Reason::truncated, in.at() - 1, kSignature);
        }
        out.signature = in.take_octets(octets);
    }
    return {};
}

void append_routable(SessionHeader const& session, std::span<RoutablePayload const> payloads,
                     std::vector<std::uint8_t>& out) {
    std::size_t user = 0;
    for (RoutablePayload const& payload : payloads) {
        user += kPayloadHeader + payload.apdu.size();
    }
    std::size_t const common = kFixedHeader + session.initialisation_vector.size();
    out.push_back(1); // octets of the transport header behind this one
    out.push_back(kUnitData);
    out.push_back(session.goose ? kGooseSession : kSvSession);
    out.push_back(static_cast<std::uint8_t>(common + 2));
    out.push_back(kCommonHeader);
    out.push_back(static_cast<std::uint8_t>(common));
    append_be(out, static_cast<std::uint32_t>(user));
    append_be(out, session.spdu_number);
    append_be(out, session.version);
    append_be(out, session.time_of_current_key);
    append_be(out, session.time_to_next_key);
    append_be(out, session.key_id);
    out.push_back(static_cast<std::uint8_t>(session.initialisation_vector.size()));
    append(out, session.initialisation_vector);
    append_be(out, static_cast<std::uint32_t>(user));
    for (RoutablePayload const& payload : payloads) {
        out.push_back(payload.goose ? kGoosePayload : kSvPayload);
        out.push_back(payload.simulated ? 1 : 0);
        append_be(out, payload.app_id);
        append_be(out, static_cast<std::uint16_t>(payload.apdu.size()));
        append(out, payload.apdu);
    }
}

std::vector<std::uint8_t> encode_routable(SessionHeader const& session, std::span<RoutablePayload const> payloads) {
    std::vector<std::uint8_t> out;
    append_routable(session, payloads, out);
    return out;
}

Mac RoutableAddress::group() const noexcept {
    return {
        {0x01, 0x00, 0x5E, static_cast<std::uint8_t>(ip_destination[1] & 0x7FU), ip_destination[2], ip_destination[3]}};
}

void append_udp_header(RoutableAddress const& address, std::vector<std::uint8_t>& out) {
    append_ethernet_header(out, address.destination, address.source, address.vlan, kIpv4);
    out.push_back(0x45); // version 4, a header of 20 octets
    out.push_back(static_cast<std::uint8_t>(address.dscp << 2U));
    append_be(out, std::uint16_t{0});      // total length
    append_be(out, std::uint16_t{0});      // identification
    append_be(out, std::uint16_t{0x4000}); // not to be fragmented
    out.push_back(address.ttl);
    out.push_back(kUdp);
    append_be(out, std::uint16_t{0}); // checksum
    append(out, address.ip_source);
    append(out, address.ip_destination);
    append_be(out, kRoutablePort);
    append_be(out, kRoutablePort);
    append_be(out, std::uint32_t{0}); // length and checksum
}

void complete_udp_frame(std::span<std::uint8_t> frame) {
    auto const ip = frame.subspan(ethernet_header_octets(frame));
    store_be(ip.data() + 2, static_cast<std::uint16_t>(ip.size()));
    store_be(ip.data() + 10, std::uint16_t{0});
    store_be(ip.data() + 10, checksum(sum_of(ip.first(kIpHeader))));
    auto const udp = ip.subspan(kIpHeader);
    store_be(udp.data() + 4, static_cast<std::uint16_t>(udp.size()));
    store_be(udp.data() + 6, std::uint16_t{0});
    std::uint32_t const pseudo = sum_of(ip.subspan(12, 8), kUdp + static_cast<std::uint32_t>(udp.size()));
    std::uint16_t const sum = checksum(sum_of(udp, pseudo));
    store_be(udp.data() + 6, sum == 0 ? std::uint16_t{0xFFFF} : sum); // 0 would say that there is none
}

std::vector<std::uint8_t> udp_frame(RoutableAddress const& address, Octets datagram) {
    std::vector<std::uint8_t> out;
    append_udp_header(address, out);
    append(out, datagram);
    complete_udp_frame(out);
    return out;
}

Octets routable_payload(Octets frame) noexcept {
    std::size_t const at = ethernet_header_octets(frame);
    if (frame.size() < at + kIpHeader || load_be<std::uint16_t>(frame.data() + at - 2) != kIpv4) {
        return {};
    }
    Octets const ip = frame.subspan(at);
    std::size_t const header = std::size_t{ip[0] & 0xFU} * 4, total = load_be<std::uint16_t>(ip.data() + 2);
    bool const fragment = (load_be<std::uint16_t>(ip.data() + 6) & 0x3FFFU) != 0;
    if (ip[0] >> 4U != 4 || header < kIpHeader || ip[9] != kUdp || fragment || total > ip.size() ||
        total < header + kUdpHeader) {
        return {};
    }
    Octets const udp = ip.first(total).subspan(header);
    std::size_t const length = load_be<std::uint16_t>(udp.data() + 4);
    if (load_be<std::uint16_t>(udp.data() + 2) != kRoutablePort || length < kUdpHeader || length > udp.size()) {
        return {};
    }
    return udp.first(length).subspan(kUdpHeader);
}

std::uint16_t stream_ethertype(Octets frame) noexcept {
    std::uint16_t const ethertype = ethertype_of(frame);
    if (ethertype != kIpv4) {
        return ethertype;
    }
    Octets datagram = routable_payload(frame);
    datagram = datagram.size() > 2 && datagram[0] == 1 ? datagram.subspan(2) : datagram; // the transport header
    return datagram.empty()               ? ethertype
           : datagram[0] == kGooseSession ? kGooseEthertype
           : datagram[0] == kSvSession    ? kSvEthertype
                                          : ethertype;
}

void as_ethernet(Mac const& destination, Mac const& source, RoutablePayload const& payload,
                 std::vector<std::uint8_t>& out) {
    out.clear();
    append_header(out, {destination, source, std::nullopt, payload.app_id, payload.simulated},
                  payload.goose ? kGooseEthertype : kSvEthertype);
    append(out, payload.apdu);
    store_be(out.data() + 16, static_cast<std::uint16_t>(kHeaderOctets + payload.apdu.size()));
}

void as_ethernet(Octets frame, RoutablePayload const& payload, std::vector<std::uint8_t>& out) {
    Mac destination, source;
    std::copy_n(frame.begin(), 6, destination.octets.begin());
    std::copy_n(frame.begin() + 6, 6, source.octets.begin());
    as_ethernet(destination, source, payload, out);
}

} // namespace gridspace::iec61850
