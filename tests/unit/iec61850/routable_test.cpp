// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/routable_sender.hpp"
#include "gateways/iec61850/sv.hpp"

#include <gtest/gtest.h>

namespace gridspace::iec61850 {
namespace {

/// The APDU of a golden Ethernet frame of GOOSE.
Buffer goose_apdu() {
    Buffer const frame = concat(addresses(), from_hex(kGoldenGoose));
    FrameHeader header;
    EXPECT_TRUE(decode_header(frame, header));
    return {header.apdu.begin(), header.apdu.end()};
}

RoutablePayload payload(Octets apdu, std::uint16_t app_id = 0x8001) {
    return {true, false, app_id, apdu};
}

TEST(Routable, ReadsWhatAnotherToolWrote) { // octets by hand after IEC 61850-8-1:2011/AMD1:2020, shown so by Wireshark
    Buffer const datagram = concat(
        concat(from_hex("0140 a11f 801d 00000046 00000001 0002 00000007 0008 00000009 08 3132333435363738 00000046"
                        "8100 8001 0042"),
               goose_apdu()),
        from_hex("8508 6162636465666768"));
    RoutableFrame frame;
    auto const read = decode_routable(datagram, frame);
    ASSERT_TRUE(read) << describe(read.error());
    EXPECT_TRUE(frame.session.goose);
    EXPECT_EQ(frame.session.spdu_number, 1U);
    EXPECT_EQ(frame.session.time_of_current_key, 7U);
    EXPECT_EQ(frame.session.time_to_next_key, 8U);
    EXPECT_EQ(frame.session.key_id, 9U);
    EXPECT_EQ(frame.session.initialisation_vector.size(), 8U);
    EXPECT_EQ(frame.signature.size(), 8U);
    ASSERT_EQ(frame.count, 1U);
    EXPECT_EQ(frame.payloads[0].app_id, 0x8001);
    EXPECT_EQ(to_hex(frame.payloads[0].apdu), to_hex(goose_apdu()));
}

TEST(Routable, WhatIsWrittenIsRead) {
    Buffer const apdu = goose_apdu();
    SessionHeader session;
    session.spdu_number = 0x01020304;
    session.key_id = 5;
    std::vector<RoutablePayload> const payloads{payload(apdu), payload(apdu, 2)};
    Buffer const datagram = encode_routable(session, payloads);
    RoutableFrame frame;
    ASSERT_TRUE(decode_routable(datagram, frame));
    EXPECT_EQ(frame.session.spdu_number, session.spdu_number);
    EXPECT_EQ(frame.session.key_id, 5U);
    ASSERT_EQ(frame.count, 2U);
    EXPECT_EQ(frame.payloads[1].app_id, 2);
    EXPECT_EQ(to_hex(frame.payloads[1].apdu), to_hex(apdu));
    EXPECT_TRUE(decode_routable(Octets{datagram}.subspan(2), frame)) << "the transport header may be gone already";
}

TEST(Routable, AMessageOfADatagramIsThatOfAnEthernetFrame) {
    Buffer const apdu = goose_apdu();
    Buffer const frame = as_ethernet(*Mac::parse("01:00:5E:01:01:01"), *Mac::parse("02:00:00:00:00:01"), payload(apdu));
    GooseFrame message;
    ASSERT_TRUE(decode_goose(frame, message));
    EXPECT_EQ(message.gocb_ref, "A/LLN0$GO$g");
    EXPECT_EQ(message.header.app_id, 0x8001);
    EXPECT_FALSE(message.simulated());
    RoutablePayload simulated = payload(apdu);
    simulated.simulated = true;
    Buffer const from_test_set = as_ethernet({}, {}, simulated);
    ASSERT_TRUE(decode_goose(from_test_set, message));
    EXPECT_TRUE(message.simulated());
}

TEST(Routable, SampledValuesHaveASessionOfTheirOwn) {
    Buffer const golden = concat(addresses(), from_hex(kGoldenSv));
    FrameHeader header;
    ASSERT_TRUE(decode_header(golden, header));
    SessionHeader session;
    session.goose = false;
    RoutablePayload const one{false, false, 0x4000, header.apdu};
    Buffer const datagram = encode_routable(session, {&one, 1});
    EXPECT_EQ(datagram[2], 0xA2);
    RoutableFrame frame;
    ASSERT_TRUE(decode_routable(datagram, frame));
    EXPECT_FALSE(frame.session.goose);
    ASSERT_EQ(frame.count, 1U);
    EXPECT_FALSE(frame.payloads[0].goose);
    SvFrame samples;
    EXPECT_TRUE(decode_sv(as_ethernet({}, {}, frame.payloads[0]), samples));
}

TEST(Routable, IsFoundInUdpToItsPortAndNowhereElse) {
    Buffer const apdu = goose_apdu();
    RoutablePayload const one = payload(apdu);
    Buffer const datagram = encode_routable({}, {&one, 1});
    RoutableAddress address;
    address.ip_destination = {239, 129, 1, 1};
    address.ip_source = {10, 0, 0, 1};
    address.destination = address.group();
    EXPECT_EQ(address.destination.to_string(), "01:00:5E:01:01:01");
    Buffer const frame = udp_frame(address, datagram);
    EXPECT_EQ(to_hex(routable_payload(frame)), to_hex(datagram));
    Buffer tagged = frame;
    Buffer const tag = from_hex("8100 8064");
    tagged.insert(tagged.begin() + 12, tag.begin(), tag.end());
    EXPECT_EQ(to_hex(routable_payload(tagged)), to_hex(datagram));
    Buffer other_port = frame, fragment = frame, tcp = frame;
    other_port[14 + 20 + 3] = 53;
    fragment[14 + 6] = 0x20;
    tcp[14 + 9] = 6;
    for (Buffer const& none : {other_port, fragment, tcp, Buffer(frame.begin(), frame.begin() + 40)}) {
        EXPECT_TRUE(routable_payload(none).empty());
    }
}

/// What RoutableSender makes of the golden Ethernet frame of GOOSE.
Buffer sent_over_udp(RoutableSender& sender) {
    Buffer const ethernet = concat(addresses(), from_hex(kGoldenGoose));
    FrameHeader header;
    EXPECT_TRUE(decode_header(ethernet, header));
    Buffer out(2000, 0xEE); // of a longer one before
    sender.wrap(header, out);
    return out;
}

TEST(Routable, EachMessageOfAStreamIsInADatagramWithANumberOfItsOwn) {
    RoutableAddress address;
    address.ip_destination = {239, 192, 0, 2};
    address.ip_source = {10, 0, 0, 1};
    address.vlan = VlanTag{5, 6};
    RoutableSender sut{address};
    for (std::uint32_t n = 0; n < 3; ++n) {
        Buffer const frame = sent_over_udp(sut);
        EXPECT_EQ(to_hex(Buffer(frame.begin(), frame.begin() + 6)), "01005e400002");
        EXPECT_EQ(load_be<std::uint16_t>(frame.data() + 14), (VlanTag{5, 6}.tci()));
        RoutableFrame datagram;
        ASSERT_TRUE(decode_routable(routable_payload(frame), datagram));
        EXPECT_EQ(datagram.session.spdu_number, n);
        ASSERT_EQ(datagram.count, 1U);
        EXPECT_EQ(to_hex(datagram.payloads[0].apdu), to_hex(goose_apdu()));
        EXPECT_EQ(frame.size(), 18 + kRoutableOverhead + goose_apdu().size());
        address.destination = address.group();
        address.source = {{frame[6], frame[7], frame[8], frame[9], frame[10], frame[11]}};
        EXPECT_EQ(to_hex(frame), to_hex(udp_frame(address, routable_payload(frame)))) << "headers and checksums";
    }
}

TEST(Routable, TheKindOfAStreamIsKnownFromItsSession) {
    RoutableSender sut{{}};
    Buffer frame = sent_over_udp(sut);
    EXPECT_EQ(stream_ethertype(frame), kGooseEthertype);
    EXPECT_EQ(ethertype_of(frame), 0x0800);
    std::size_t const session = 14 + 20 + 8 + 2;
    frame[session] = 0xA2;
    EXPECT_EQ(stream_ethertype(frame), kSvEthertype);
    frame[session] = 0xA3; // management
    EXPECT_EQ(stream_ethertype(frame), 0x0800);
    Buffer const ethernet = concat(addresses(), from_hex(kGoldenGoose));
    EXPECT_EQ(stream_ethertype(ethernet), kGooseEthertype);
    for (std::size_t n = 0; n < frame.size(); ++n) {
        EXPECT_NE(stream_ethertype(Octets{frame}.first(n)), kGooseEthertype) << n;
    }
}

TEST(Routable, EveryPrefixIsRefusedWithAReason) {
    Buffer const apdu = goose_apdu();
    RoutablePayload const one = payload(apdu);
    Buffer const datagram = encode_routable({}, {&one, 1});
    RoutableFrame frame;
    for (std::size_t n = 0; n < datagram.size(); ++n) {
        auto const read = decode_routable(Octets{datagram}.first(n), frame);
        ASSERT_FALSE(read) << n;
        EXPECT_NE(read.error().reason, Reason::none);
        EXPECT_LE(read.error().offset, n);
    }
    Buffer other = datagram;
    other[2] = 0xA3; // management
    EXPECT_EQ(decode_routable(other, frame).error().reason, Reason::bad_tag);
    Buffer none = encode_routable({}, {});
    EXPECT_EQ(decode_routable(none, frame).error().reason, Reason::missing_field);
}

} // namespace
} // namespace gridspace::iec61850
