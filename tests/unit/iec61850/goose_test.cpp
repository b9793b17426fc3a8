// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/quality.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

Address goose_address() {
    return {*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02-00-00-00-00-01"), VlanTag{}, 0x8001, false};
}

Buffer golden() {
    return concat(addresses(), from_hex(kGoldenGoose));
}

GooseState golden_state() {
    GooseState out;
    out.st_num = 2;
    out.live_ms = 6;
    out.t = UtcTime::from_bits(0x5de2ff8000000018);
    return out;
}

std::string encoded(Value const& value, IntegerForm form = IntegerForm::minimal) {
    Buffer buffer(300);
    BerWriter writer{buffer};
    write_data_value(writer, value, form);
    return to_hex(Octets{buffer}.first(writer.size()));
}

Tlv element(Buffer const& octets) {
    BerCursor cursor{octets, 0};
    Tlv out;
    EXPECT_EQ(cursor.next(out), Reason::none);
    return out;
}

TEST(GooseTemplate, WritesTheMessageOfAnIndependentPeerOctetForOctet) {
    auto sut = GooseTemplate::create(goose_address(), one_boolean());
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->set(0, Value::of(true)), GooseTemplate::Stored::changed);
    EXPECT_EQ(to_hex(sut->frame(golden_state())), to_hex(golden()));
}

TEST(GooseDecoder, ReadsTheMessageOfAnIndependentPeer) {
    Buffer const frame = golden();
    GooseFrame sut;
    ASSERT_TRUE(decode_goose(frame, sut));
    EXPECT_EQ(sut.gocb_ref, "A/LLN0$GO$g");
    EXPECT_EQ(sut.dat_set, "A/LLN0$d");
    EXPECT_EQ(sut.go_id, "G");
    EXPECT_EQ(sut.live_ms, 6U);
    EXPECT_EQ(sut.st_num, 2U);
    EXPECT_EQ(sut.sq_num, 0U);
    EXPECT_EQ(sut.conf_rev, 1U);
    EXPECT_EQ(sut.entries, 1U);
    EXPECT_EQ(sut.declared_entries, 1U);
    EXPECT_EQ(sut.t.seconds, 0x5de2ff80U);
    EXPECT_FALSE(sut.simulated());
    EXPECT_EQ(sut.header.app_id, 0x8001);
}

TEST(GooseData, EncodesAsAnIndependentPeerDoes) {
    EXPECT_EQ(encoded(Value::of(true)), "830101");
    EXPECT_EQ(encoded(Value::of(1.0F)), "8705083f800000");
    EXPECT_EQ(encoded(Value::integer(BasicType::int32, -129)), "8502ff7f");
    EXPECT_EQ(encoded(Value::integer(BasicType::int32, 128)), "85020080");
    EXPECT_EQ(encoded(Value::integer(BasicType::uint32, 200)), "860200c8");
    EXPECT_EQ(encoded(Value::quality(quality::kInvalid | quality::kTest)), "8403034010");
    EXPECT_EQ(encoded(Value::of(UtcTime::from_nanoseconds(1'500'000'000, 0x0A))), "9108000000018000000a");
    EXPECT_EQ(encoded(Value::visible("ab")), "8a026162");
    EXPECT_EQ(encoded({BasicType::position, 0, 1, {}}), "84020640");
    EXPECT_EQ(encoded({BasicType::position, 0, 2, {}}), "84020680");
    EXPECT_EQ(encoded(Value::of(1.0)), "87090b3ff0000000000000");
    EXPECT_EQ(encoded(Value::integer(BasicType::int16, -1), IntegerForm::fixed), "8503ffffff");
    EXPECT_EQ(encoded(Value::integer(BasicType::uint32, 5), IntegerForm::fixed), "86050000000005");
}

TEST(GooseData, ReadsIntegersInEveryFormAndRefusesThoseOutOfRange) {
    auto const read = [](char const* hex, BasicType type) {
        Buffer const octets = from_hex(hex);
        auto const value = read_data_value(element(octets), type);
        return value ? std::optional{value->as_signed()} : std::nullopt;
    };
    EXPECT_EQ(read("8501ff", BasicType::int8), -1);
    EXPECT_EQ(read("8504ffffffff", BasicType::int8), -1);
    EXPECT_EQ(read("85020080", BasicType::int8), std::nullopt);
    EXPECT_EQ(read("8501ff", BasicType::uint8), std::nullopt);
    EXPECT_EQ(read("860200ff", BasicType::uint8), 255);
    EXPECT_EQ(read("8601ff", BasicType::uint8), 255);
    EXPECT_EQ(read("860100", BasicType::int32), 0);
    EXPECT_EQ(read("8500", BasicType::int32), std::nullopt);
    EXPECT_EQ(read("850900ffffffffffffffff", BasicType::int64), std::nullopt);
    EXPECT_EQ(read("8509007fffffffffffffff", BasicType::int64), std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(read("85020102", BasicType::boolean), std::nullopt);
}

TEST(GooseData, TellsTypesApart) {
    Buffer const boolean = from_hex("8301ff"), quality = from_hex("8403034010"), two_bits = from_hex("84020680");
    EXPECT_TRUE(read_data_value(element(boolean), BasicType::boolean)->boolean());
    EXPECT_EQ(read_data_value(element(quality), BasicType::quality)->bits, 0x802U);
    EXPECT_FALSE(read_data_value(element(quality), BasicType::position));
    EXPECT_EQ(read_data_value(element(two_bits), BasicType::position)->bits, 2U);
    EXPECT_FALSE(read_data_value(element(two_bits), BasicType::quality));
    EXPECT_FALSE(read_data_value(element(boolean), BasicType::float32));
    EXPECT_EQ(to_string(*read_any_data_value(element(two_bits))), "closed");
}

TEST(GooseData, RefusesMalformedBitStrings) {
    for (char const* hex : {"8400", "840101", "840208ff", "8402ffff", "840180"}) {
        Buffer const octets = from_hex(hex);
        EXPECT_FALSE(read_any_data_value(element(octets))) << hex;
        EXPECT_FALSE(check_data(octets, 0)) << hex;
    }
    EXPECT_TRUE(check_data(from_hex("840100"), 0)) << "an empty bit string is one";
}

TEST(GooseTemplate, MovesWhatStandsBehindAnIntegerThatGrows) {
    GooseDescription description = one_boolean();
    description.data_set = {{DataNode::leaf("n", BasicType::int32), DataNode::leaf("status", BasicType::boolean)}};
    auto sut = GooseTemplate::create(goose_address(), description);
    ASSERT_TRUE(sut);
    sut->set(1, Value::of(true));
    GooseState state = golden_state();
    std::size_t last = 0;
    for (std::int64_t const n : {1LL, 200LL, 40'000LL, 9'000'000LL, 1LL, -2'000'000'000LL}) {
        ASSERT_EQ(sut->set(0, Value::integer(BasicType::int32, n)), GooseTemplate::Stored::changed);
        state.sq_num = static_cast<std::uint32_t>(std::abs(n));
        Octets const frame = sut->frame(state);
        GooseFrame decoded;
        ASSERT_TRUE(decode_goose(frame, decoded));
        EXPECT_EQ(decoded.sq_num, state.sq_num);
        EXPECT_NE(frame.size(), last);
        last = frame.size();
        DataWalker walker{decoded.all_data, decoded.all_data_offset};
        Tlv e;
        ASSERT_TRUE(walker.next(e));
        EXPECT_EQ(read_data_value(e, BasicType::int32)->as_signed(), n);
        ASSERT_TRUE(walker.next(e));
        EXPECT_TRUE(read_data_value(e, BasicType::boolean)->boolean());
        EXPECT_FALSE(walker.next(e));
    }
}

TEST(GooseTemplate, KeepsItsLengthInTheFixedForm) {
    GooseDescription description = one_boolean();
    description.integers = IntegerForm::fixed;
    auto sut = GooseTemplate::create(goose_address(), description);
    GooseState state;
    std::size_t const size = sut->frame(state).size();
    state.sq_num = state.st_num = state.live_ms = 0xFFFFFFFF;
    Octets const frame = sut->frame(state);
    EXPECT_EQ(frame.size(), size);
    GooseFrame decoded;
    ASSERT_TRUE(decode_goose(frame, decoded));
    EXPECT_EQ(decoded.sq_num, 0xFFFFFFFFU);
}

TEST(GooseTemplate, MarksSimulationInBothPlaces) {
    auto sut = GooseTemplate::create(goose_address(), one_boolean());
    GooseState state;
    state.simulation = true;
    GooseFrame decoded;
    Buffer const copy{sut->frame(state).begin(), sut->frame(state).end()};
    ASSERT_TRUE(decode_goose(copy, decoded));
    EXPECT_TRUE(decoded.simulation);
    EXPECT_TRUE(decoded.header.simulated());
    state.simulation = false;
    ASSERT_TRUE(decode_goose(sut->frame(state), decoded));
    EXPECT_FALSE(decoded.simulated());
}

TEST(GooseTemplate, WritesStructuresAndArrays) {
    GooseDescription description = one_boolean();
    DataNode structure{"pos",
                       DataNode::Kind::structure,
                       {},
                       0,
                       {DataNode::leaf("stVal", BasicType::position), DataNode::leaf("q", BasicType::quality)}};
    DataNode array{"h",
                   DataNode::Kind::array,
                   {},
                   0,
                   {DataNode::leaf("", BasicType::float32), DataNode::leaf("", BasicType::float32)}};
    description.data_set.members = {structure, array};
    auto sut = GooseTemplate::create(goose_address(), description);
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->index_of("pos.q"), 1U);
    EXPECT_EQ(sut->index_of("h.1"), 3U);
    sut->set(0, {BasicType::position, 0, 2, {}});
    sut->set(3, Value::of(1.0F));
    GooseFrame decoded;
    ASSERT_TRUE(decode_goose(sut->frame({}), decoded));
    EXPECT_EQ(to_hex(decoded.all_data), "a209840206808403030000a10e870508000000008705083f800000");
    EXPECT_EQ(decoded.declared_entries, 2U);
    EXPECT_EQ(decoded.entries, 2U);
}

TEST(GooseTemplate, RefusesValuesThatDoNotFit) {
    GooseDescription description = one_boolean();
    description.data_set = {{DataNode::leaf("n", BasicType::int8), DataNode::leaf("u", BasicType::uint16),
                             DataNode::leaf("s", BasicType::visible_string, 4)}};
    auto sut = GooseTemplate::create(goose_address(), description);
    using Stored = GooseTemplate::Stored;
    EXPECT_EQ(sut->set(0, Value::integer(BasicType::int8, 128)), Stored::refused);
    EXPECT_EQ(sut->set(0, Value::integer(BasicType::int8, -128)), Stored::changed);
    EXPECT_EQ(sut->set(0, Value::integer(BasicType::int16, 1)), Stored::refused);
    EXPECT_EQ(sut->set(1, Value::integer(BasicType::uint16, 65536)), Stored::refused);
    EXPECT_EQ(sut->set(1, Value::integer(BasicType::uint16, 65535)), Stored::changed);
    EXPECT_EQ(sut->set(1, Value::integer(BasicType::uint16, 65535)), Stored::same);
    EXPECT_EQ(sut->set(2, Value::visible("abcde")), Stored::refused);
    EXPECT_EQ(sut->set(2, Value::visible("abcd")), Stored::changed);
    EXPECT_EQ(to_string(sut->get(2)), "abcd");
}

TEST(GooseTemplate, RefusesADataSetThatEthernetCannotCarry) {
    GooseDescription description = one_boolean();
    auto const fits = [&](std::size_t booleans) {
        description.data_set.members.assign(booleans, DataNode::leaf("b", BasicType::boolean));
        return GooseTemplate::create(goose_address(), description).has_value();
    };
    std::size_t most = 300;
    while (fits(most + 1)) {
        ++most;
    }
    EXPECT_GT(most, 450U);
    EXPECT_LT(most, 500U);
    auto sut = GooseTemplate::create(goose_address(), one_boolean());
    description.data_set.members.assign(most, DataNode::leaf("b", BasicType::boolean));
    auto longest = GooseTemplate::create(goose_address(), description);
    GooseState state{0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, {}, false, false};
    std::size_t const octets = longest->frame(state).size() - 18;
    EXPECT_LE(octets, 1500U);
    EXPECT_GT(octets, 1497U);
}

TEST(GooseDecoder, AcceptsTheAbsenceOfDefaultsAndTheBooleanFF) {
    Buffer frame = concat(
        addresses(), from_hex("88b8 8001 0040 0000 0000 6136 800b412f4c4c4e3024474f2467 810106 8208412f4c4c4e302464"
                              "8408 5de2ff8000000018 850102 860100 880101 8a0101 ab03 8301ff"));
    store_be(frame.data() + 16, static_cast<std::uint16_t>(frame.size() - 14));
    frame[23] = static_cast<std::uint8_t>(frame.size() - 24);
    GooseFrame sut;
    auto const ok = decode_goose(frame, sut);
    ASSERT_TRUE(ok) << describe(ok.error());
    EXPECT_FALSE(sut.has(GooseFrame::go_id_field));
    EXPECT_FALSE(sut.nds_com);
    EXPECT_EQ(sut.entries, 1U);
}

TEST(GooseDecoder, LimitsNestingButNotBelowWhatDevicesSend) {
    auto const nested = [](std::size_t depth) {
        Buffer inner = from_hex("830101");
        for (std::size_t i = 0; i < depth; ++i) {
            inner = concat({0xA2, static_cast<std::uint8_t>(inner.size())}, inner);
        }
        return inner;
    };
    EXPECT_TRUE(check_data(nested(1), 0));
    EXPECT_TRUE(check_data(nested(16), 0));
    ASSERT_FALSE(check_data(nested(17), 0));
    EXPECT_EQ(check_data(nested(17), 0).error().reason, Reason::too_deep);
    EXPECT_FALSE(check_data(nested(50), 0));
}

TEST(Mac, ReadsBothWaysOfWriting) {
    EXPECT_EQ(Mac::parse("01:0c:CD:04:00:21")->to_string(), "01:0C:CD:04:00:21");
    EXPECT_TRUE(Mac::parse("01-0C-CD-04-00-21"));
    for (char const* bad :
         {"", "01:0C:CD:04:00", "01:0C:CD:04:00:2g", "01:0C-CD:04:00:21", "010CCD040021", "01:0C:CD:04:00:211"}) {
        EXPECT_FALSE(Mac::parse(bad)) << bad;
    }
}

TEST(UtcTime, RoundsAndCarries) {
    EXPECT_EQ(UtcTime::from_nanoseconds(1'999'999'999), (UtcTime{2, 0, 0}));
    for (std::int64_t const ns : {0LL, 1LL, 208'333LL, 999'999'000LL, 1'575'158'400'123'456'789LL}) {
        EXPECT_NEAR(static_cast<double>(UtcTime::from_nanoseconds(ns).nanoseconds() - ns), 0, 31) << ns;
    }
}

} // namespace
} // namespace gridspace::iec61850
