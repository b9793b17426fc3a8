// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// On a secured bus anybody may announce himself and begin a handshake. All else has to be protected.
#include "bus/rtps_guard/message_guard.hpp"
#include "bus/rtps_guard/token_guard.hpp"
#include "tests/support/rtps_message.hpp"

#include <gmock/gmock.h>

namespace gridspace::rtps_guard {
namespace {

using namespace test;

constexpr Rules kSecured{true, true};
constexpr std::uint32_t kWriter = 0x00000102, kHandshakeWriter = 0x000201c3, kHandshakeReader = 0x000201c4;
Bytes const kPayload{0, 1, 0, 0, 7, 0, 0, 0};
Bytes const kPrefix = Bytes(20), kFooter = Bytes(20);

Refusal refusal_of(Bytes message, Rules rules = kSecured) {
    return examine(message, rules).refusal;
}
Bytes heartbeat() {
    return submessage(0x07, joined({entity(0x107), entity(kWriter), number(1), number(4), little(1, 4)}));
}
/// A body of encrypted octets that says it has `octets`.
Bytes body(std::uint8_t octets, std::size_t there = 8) {
    return submessage(0x30, joined({{0, 0, 0, octets}, Bytes(there)}));
}
Bytes token(std::uint32_t properties = 1) {
    return joined({text("DDS:Auth:PKI-DH:1.0"),
                   little(properties, 4),
                   text("dds.cert.sn"),
                   text("CN=relay23,O=G"),
                   {0, 0, 0, 0}});
}
Bytes padded(Bytes what) {
    what.resize((what.size() + 3) / 4 * 4);
    return what;
}
Bytes handshake(std::uint32_t holders = 1, std::uint32_t octets = 4) {
    Bytes out{0, 1, 0, 0};
    append(out, Bytes(96));
    for (Bytes const& part : {padded(text("dds.sec.auth")), little(holders, 4), padded(text("DDS:Auth:PKI-DH:1.0+Req")),
                              little(0, 4), little(1, 4), padded(text("c.id")), little(octets, 4), Bytes(4)}) {
        append(out, part);
    }
    return out;
}
Bytes handshake_message(Bytes const& payload) {
    return message({data(kHandshakeReader, kHandshakeWriter, payload)});
}

TEST(SecuredBus, AnnouncementsAndHandshakesPassAndNothingElseThatIsPlain) {
    EXPECT_EQ(refusal_of(message({announcement(1)})), Refusal::none);
    EXPECT_EQ(refusal_of(handshake_message(handshake())), Refusal::none);
    for (Bytes const& plain :
         {heartbeat(), data(0, kWriter, kPayload), endpoint(1, kWriter, "t", "T", 1),
          submessage(0x06, joined({entity(0x107), entity(kWriter), number(1), little(0, 4), little(1, 4)})),
          submessage(0x08, joined({entity(0x107), entity(kWriter), number(1), number(2), little(0, 4)}))}) {
        EXPECT_EQ(refusal_of(message({plain})), Refusal::unprotected);
        EXPECT_EQ(refusal_of(message({announcement(1), plain})), Refusal::unprotected);
        EXPECT_EQ(refusal_of(message({plain}), {}), Refusal::none); // where there is no security
    }
}

TEST(SecuredBus, AFarewellThatAnybodyCouldSayIsRefused) {
    Bytes const key = joined({{0, 3, 0, 0}, parameter(0x0050, joined({guid_prefix(1), entity(0x1c1)})), kSentinel});
    Bytes const farewell = message({data(kParticipantReader, kParticipantWriter, key, 1, 9)});
    EXPECT_EQ(refusal_of(farewell), Refusal::farewell);
    EXPECT_EQ(refusal_of(farewell, {}), Refusal::none);
}

TEST(SecuredBus, WhatIsProtectedPassesInItsFrame) {
    EXPECT_EQ(refusal_of(message({submessage(0x33, kPrefix), body(8), submessage(0x34, kFooter)})), Refusal::none);
    EXPECT_EQ(refusal_of(message({submessage(0x33, kPrefix), heartbeat(), submessage(0x34, kFooter), kStatistics})),
              Refusal::none);
    EXPECT_EQ(refusal_of(message({submessage(0x0e, guid_prefix(2)), submessage(0x31, kPrefix), body(8),
                                  submessage(0x32, kFooter), submessage(0x31, kPrefix), heartbeat(),
                                  submessage(0x32, kFooter)})),
              Refusal::none);
    EXPECT_EQ(refusal_of(message({submessage(0x33, kPrefix), submessage(0x31, kPrefix), body(8),
                                  submessage(0x32, kFooter), submessage(0x34, kFooter)})),
              Refusal::none);
    EXPECT_EQ(refusal_of(message({submessage(0x31, kPrefix), body(8), submessage(0x32, kFooter)}), {}),
              Refusal::kind); // without security
}

TEST(SecuredBus, AFrameThatIsNotWholeIsRefused) {
    for (Bytes const& bad :
         {message({submessage(0x33, kPrefix), heartbeat()}), message({submessage(0x31, kPrefix), heartbeat()}),
          message({announcement(1), submessage(0x33, kPrefix), heartbeat(), submessage(0x34, kFooter)}),
          message({submessage(0x33, kPrefix), heartbeat(), submessage(0x34, kFooter), announcement(1)}),
          message({submessage(0x34, kFooter)}), message({submessage(0x32, kFooter)}), message({body(8)}),
          message({submessage(0x33, Bytes(16)), heartbeat(), submessage(0x34, kFooter)}),
          message({submessage(0x31, kPrefix), submessage(0x31, kPrefix), body(8), submessage(0x32, kFooter)}),
          message({submessage(0x33, kPrefix), heartbeat(), submessage(0x34, Bytes(16))})}) {
        EXPECT_EQ(refusal_of(bad), Refusal::content);
    }
}

TEST(SecuredBus, ABodyThatSaysMoreThanItHasIsRefused) {
    EXPECT_EQ(refusal_of(message({submessage(0x33, kPrefix), body(9), submessage(0x34, kFooter)})), Refusal::content);
    EXPECT_EQ(refusal_of(message({submessage(0x31, kPrefix), body(200), submessage(0x32, kFooter)})), Refusal::content);
}

TEST(SecuredBus, TokensOfAnAnnouncementStayWhereTheyAreSoundAndBecomePaddingWithoutSecurity) {
    Bytes good = message({announcement(1, parameter(0x1001, token()))});
    Bytes const before = good;
    EXPECT_EQ(examine(good, kSecured).refusal, Refusal::none);
    EXPECT_EQ(good, before);
    EXPECT_EQ(examine(good, {}).refusal, Refusal::none);
    EXPECT_NE(good, before);
    EXPECT_EQ(refusal_of(message({announcement(1, parameter(0x1001, token(0x7fffffff)))})), Refusal::parameters);
    EXPECT_EQ(refusal_of(message({announcement(1, parameter(0x1005, Bytes(4)))})), Refusal::parameters);
}

TEST(SecuredBus, AHandshakeWhoseNumbersPromiseMoreThanThereIsIsRefused) {
    EXPECT_EQ(refusal_of(handshake_message(handshake(0x7fffffff))), Refusal::content);
    EXPECT_EQ(refusal_of(handshake_message(handshake(2))), Refusal::content);
    EXPECT_EQ(refusal_of(handshake_message(handshake(1, 0xfffffff0))), Refusal::content);
    Bytes const whole = handshake();
    for (std::size_t size = 0; size < whole.size(); size += 4) {
        EXPECT_FALSE(is_generic_message(Octets{std::span{const_cast<std::uint8_t*>(whole.data()), size}})) << size;
    }
}

} // namespace
} // namespace gridspace::rtps_guard
