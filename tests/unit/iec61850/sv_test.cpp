// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

using testing::ElementsAre;

Buffer golden() {
    return concat(addresses(), from_hex(kGoldenSv));
}

/// A frame of one ASDU whose fields are given as hexadecimal text, lengths filled in.
Buffer frame_of(std::string_view fields, std::string_view no_asdu = "800101", std::string_view before = "",
                bool vlan = false) {
    auto const element = [](std::uint8_t tag, Buffer const& content) {
        Buffer out{tag, 0x82, static_cast<std::uint8_t>(content.size() >> 8U),
                   static_cast<std::uint8_t>(content.size())};
        return concat(out, content);
    };
    Buffer const sequence = element(0xA2, element(0x30, from_hex(fields)));
    Buffer const pdu = element(0x60, concat(concat(from_hex(no_asdu), from_hex(before)), sequence));
    Buffer head = concat(addresses(), from_hex(vlan ? "81008000 88ba" : "88ba"));
    auto const length = static_cast<unsigned>(pdu.size() + 8);
    head = concat(head,
                  {0x40, 0x00, static_cast<std::uint8_t>(length >> 8U), static_cast<std::uint8_t>(length), 0, 0, 0, 0});
    return concat(head, pdu);
}

constexpr std::string_view kPlain = "800178 82020001 830400000001 850102 870400000000";

TEST(SvDecoder, ReadsTheFrameOfAnIndependentPeer) {
    auto const frame = golden(); // what is decoded points into it
    SvFrame sut;
    ASSERT_TRUE(decode_sv(frame, sut));
    ASSERT_EQ(sut.count, 1);
    Asdu const& asdu = sut.asdus[0];
    EXPECT_EQ(asdu.sv_id, "TL11MU01");
    EXPECT_EQ(asdu.smp_cnt, 4799);
    EXPECT_EQ(asdu.conf_rev, 1U);
    EXPECT_EQ(asdu.smp_synch, kGlobalClock);
    ASSERT_EQ(asdu.sample.size(), 12U);
    EXPECT_EQ(load_float(asdu.sample, 0), 1.0F);
    EXPECT_EQ(load_float(asdu.sample, 8), -0.5F);
    EXPECT_EQ(sut.header.app_id, 0x4000);
    EXPECT_EQ(sut.header.vlan, (VlanTag{0, 4, false}));
    EXPECT_FALSE(asdu.has(Asdu::dat_set_field));
}

TEST(SvTemplate, WritesTheFrameOfAnIndependentPeerOctetForOctet) {
    auto sut = SvTemplate::create(sv_address(), {asdu("TL11MU01", 12)});
    ASSERT_TRUE(sut);
    sut->set_smp_cnt(0, 4799);
    store_float(sut->sample(0), 0, 1.0F);
    store_float(sut->sample(0), 4, -0.5F);
    store_float(sut->sample(0), 8, -0.5F);
    EXPECT_EQ(to_hex(sut->frame()), to_hex(golden()));
    EXPECT_EQ(sut->frame().size(), 72U);
}

TEST(SvTemplate, WritesAFrameOf92LE) {
    SvLayout const layout{data_set_92le()};
    ASSERT_EQ(layout.sample_octets(), 64U);
    auto sut = SvTemplate::create(sv_address(), {asdu("xxxxMUnn01", layout.sample_octets())});
    ASSERT_TRUE(sut);
    sut->set_smp_synch(0, kNotSynchronised);
    layout.write(0, Value::integer(BasicType::int32, -1000), sut->sample(0));
    layout.write(1, Value::quality(0x2), sut->sample(0));
    EXPECT_EQ(sut->frame().size(), 126U);
    EXPECT_THAT(to_hex(sut->frame().subspan(12)),
                testing::StartsWith("8100800088ba4000006c00000000"
                                    "6062800101a25d305b800a787878784d556e6e303182020000830400000001850100"
                                    "8740fffffc180000000200000000"));
}

TEST(SvTemplate, HasTheSizesOfTheStandardsVariants) {
    auto const size = [](std::size_t asdus, std::size_t octets) {
        return SvTemplate::create(sv_address(), std::vector(asdus, asdu("TL11MU01", octets)))->frame().size();
    };
    EXPECT_EQ(size(2, 12), 111U);
    EXPECT_EQ(SvTemplate::create(sv_address(), std::vector(2, asdu("xxxxMUnn01", 64)))->frame().size(), 221U);
    EXPECT_EQ(size(16, 64), 14 + 4 + 8 + 4 + 3 + 4 + 16 * (2 + 10 + 4 + 6 + 3 + 66U));
}

TEST(SvTemplate, RefusesWhatEthernetCannotCarryAndTakesWhatItJustCan) {
    auto const octets_behind = [](std::size_t sample) { // one ASDU with long length forms
        auto const t = SvTemplate::create(sv_address(), {asdu("x", sample)});
        return t ? t->frame().size() - 18 : 0;
    };
    std::size_t sample = 1400;
    while (octets_behind(sample + 1) != 0) {
        ++sample;
    }
    EXPECT_EQ(octets_behind(sample), 1500U);
    for (std::size_t const too_much : {sample + 1, std::size_t{1518}, std::size_t{65535}}) {
        auto const refused = SvTemplate::create(sv_address(), {asdu("x", too_much)});
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, testing::HasSubstr("octets behind the ethertype"));
    }
}

TEST(SvTemplate, RefusesNamesThatTheStandardDoesNotAllow) {
    EXPECT_FALSE(SvTemplate::create(sv_address(), {asdu("", 12)}));
    EXPECT_FALSE(SvTemplate::create(sv_address(), {asdu("a\nb", 12)}));
    EXPECT_TRUE(SvTemplate::create(sv_address(), {asdu(std::string(129, 'x'), 12)}));
    EXPECT_FALSE(SvTemplate::create(sv_address(), {asdu(std::string(130, 'x'), 12)}));
    EXPECT_FALSE(SvTemplate::create(sv_address(), {}));
    EXPECT_FALSE(SvTemplate::create(sv_address(), std::vector(17, asdu("x", 4))));
}

TEST(SvDecoder, ReadsEveryOptionalField) {
    AsduDescription description = asdu("MU", 4);
    description.dat_set = "MU/LLN0$d";
    description.refr_tm = true;
    description.smp_rate = 4800;
    description.smp_mod = SampleMode::per_second;
    description.gm_identity = 0x0123456789ABCDEF;
    auto stream = SvTemplate::create(sv_address(), {description});
    ASSERT_TRUE(stream);
    stream->set_refr_tm(0, UtcTime::from_nanoseconds(1'500'000'000, 0x0A));
    stream->set_simulated(true);
    SvFrame sut;
    ASSERT_TRUE(decode_sv(stream->frame(), sut));
    Asdu const& asdu = sut.asdus[0];
    EXPECT_EQ(asdu.fields, 0x3FF);
    EXPECT_EQ(asdu.dat_set, "MU/LLN0$d");
    EXPECT_EQ(asdu.refr_tm, (UtcTime{1, 0x800000, 0x0A}));
    EXPECT_EQ(asdu.smp_rate, 4800);
    EXPECT_EQ(asdu.smp_mod, 1);
    EXPECT_EQ(asdu.gm_identity, 0x0123456789ABCDEFU);
    EXPECT_TRUE(sut.header.simulated());
}

TEST(SvTemplate, LeavesAFrameAloneThatCarriesNoTime) {
    auto sut = *SvTemplate::create(sv_address(), {asdu("MU", 4)});
    Buffer const before{sut.frame().begin(), sut.frame().end()};
    sut.set_refr_tm(0, UtcTime{1, 2, 3});
    EXPECT_TRUE(std::ranges::equal(sut.frame(), before));
}

TEST(SvDecoder, TellsTheStreamsOfOneFrameApart) {
    std::vector<AsduDescription> many;
    for (int i = 0; i < 13; ++i) {
        many.push_back(asdu("MU" + std::to_string(i), 4));
    }
    auto const stream = SvTemplate::create(sv_address(), many);
    SvFrame sut;
    ASSERT_TRUE(decode_sv(stream->frame(), sut));
    ASSERT_EQ(sut.view().size(), 13U);
    EXPECT_EQ(sut.view()[12].sv_id, "MU12");
}

TEST(SvDecoder, AcceptsIntegersOfAnyLengthThatHoldsTheirValue) {
    SvFrame sut;
    for (std::string_view const counter :
         {"820101", "82020001", "8203000001", "820400000001", "8209000000000000000001"}) {
        std::string const fields = "800178 " + std::string{counter} + " 830101 850102 870400000000";
        ASSERT_TRUE(decode_sv(frame_of(fields), sut)) << counter;
        EXPECT_EQ(sut.asdus[0].smp_cnt, 1) << counter;
    }
    for (std::string_view const bad : {"8200", "8203010000", "820a00000000000000000001"}) {
        auto const result = decode_sv(frame_of("800178 " + std::string{bad} + " 830101 850102 870400000000"), sut);
        ASSERT_FALSE(result) << bad;
        EXPECT_EQ(result.error().reason, Reason::bad_value) << bad;
        EXPECT_EQ(result.error().tag, 0x82) << bad;
    }
}

TEST(SvDecoder, AcceptsAnyOrderAndSkipsUnknownFields) {
    SvFrame sut;
    ASSERT_TRUE(decode_sv(frame_of("870400000000 9f8101020000 850102 830101 820105 8a03414243 800178"), sut));
    EXPECT_EQ(sut.asdus[0].smp_cnt, 5);
    ASSERT_TRUE(decode_sv(frame_of(kPlain, "800101", "8102abcd"), sut));
    EXPECT_TRUE(sut.secured);
}

TEST(SvDecoder, NamesTheMandatoryFieldThatIsMissing) {
    SvFrame sut;
    std::vector<std::pair<std::string, int>> const fields{
        {"800178", 0x80}, {"82020001", 0x82}, {"830400000001", 0x83}, {"850102", 0x85}, {"870400000000", 0x87}};
    for (auto const& [missing, tag] : fields) {
        std::string rest;
        for (auto const& [field, other] : fields) {
            rest += other == tag ? "" : field;
        }
        auto const result = decode_sv(frame_of(rest), sut);
        ASSERT_FALSE(result) << missing;
        EXPECT_EQ(result.error().reason, Reason::missing_field);
        EXPECT_EQ(result.error().tag, tag);
        EXPECT_EQ(sut.count, 0);
    }
}

TEST(SvDecoder, RefusesWhatOccursTwiceAndWrongCounts) {
    SvFrame sut;
    EXPECT_EQ(decode_sv(frame_of("800178 800179 82020001 830101 850102 870400000000"), sut).error().reason,
              Reason::duplicate_field);
    for (std::string_view const count : {"800100", "800102", "80020100"}) {
        EXPECT_EQ(decode_sv(frame_of(kPlain, count), sut).error().reason, Reason::count_mismatch) << count;
    }
    EXPECT_EQ(decode_sv(frame_of(kPlain, ""), sut).error().reason, Reason::missing_field);
}

TEST(SvDecoder, TakesLengthsFromTheFrameAndIgnoresPadding) {
    Buffer frame = golden();
    frame.resize(frame.size() + 46, 0xFF);
    SvFrame sut;
    EXPECT_TRUE(decode_sv(frame, sut));
    for (unsigned const length : {0U, 1U, 7U, 8U, 9U, 0x35U, 0x1000U, 0xFFFFU}) {
        store_be(frame.data() + 20, static_cast<std::uint16_t>(length));
        EXPECT_FALSE(decode_sv(frame, sut)) << length;
    }
}

TEST(SvDecoder, GivesTheOffsetOfWhatIsWrong) {
    Buffer frame = golden();
    frame[34] = 0xFF; // length of the ASDU
    SvFrame sut;
    auto const result = decode_sv(frame, sut);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error(), (DecodeError{33, Reason::bad_length_form, 0x30}));
    EXPECT_EQ(describe(result.error()), "a length is in a form that is not allowed (tag 0x30, octet 33)");
}

TEST(SvLayout, PlacesEveryBasicTypeAsTheStandardSays) {
    DataSet data_set;
    for (std::size_t i = 0; i < kBasicTypes; ++i) {
        auto const type = static_cast<BasicType>(i);
        data_set.members.push_back(DataNode::leaf(std::string{type_name(type)}, type));
    }
    SvLayout const sut{data_set};
    std::vector<std::size_t> octets;
    for (SvLayout::Slot const& slot : sut.slots()) {
        octets.push_back(slot.octets);
    }
    EXPECT_THAT(octets, ElementsAre(1, 1, 2, 4, 8, 1, 2, 4, 8, 4, 8, 4, 4, 4, 4, 8, 6, 35, 20));
}

TEST(SvLayout, WritesAllAtOnceAsItWritesOneByOne) {
    DataSet const mixed{{DataNode::leaf("a", BasicType::boolean), DataNode::leaf("b", BasicType::int64),
                         DataNode::leaf("c", BasicType::visible_string), DataNode::leaf("d", BasicType::quality)}};
    for (DataSet const& set : {data_set_92le(), mixed}) {
        SvLayout const sut{set};
        std::vector<Value> values;
        for (auto const& slot : sut.slots()) {
            values.push_back({slot.leaf.type, 0, 0x8182838485868788 + values.size(), octets_of("text")});
        }
        std::vector<std::uint8_t> at_once(sut.sample_octets(), 0xEE), one_by_one(sut.sample_octets(), 0xEE);
        sut.write_all(values, at_once);
        for (std::size_t i = 0; i < values.size(); ++i) {
            sut.write(i, values[i], one_by_one);
        }
        EXPECT_EQ(at_once, one_by_one);
    }
}

TEST(SvLayout, KeepsTheSignOfSmallIntegers) {
    SvLayout const sut{{{DataNode::leaf("a", BasicType::int8), DataNode::leaf("b", BasicType::int16),
                         DataNode::leaf("s", BasicType::visible_string)}}};
    Buffer sample(sut.sample_octets(), 0xEE);
    sut.write(0, Value::integer(BasicType::int8, -2), sample);
    sut.write(1, Value::integer(BasicType::int16, -300), sample);
    sut.write(2, Value::visible("abc"), sample);
    EXPECT_EQ(sut.read(0, sample).as_signed(), -2);
    EXPECT_EQ(sut.read(1, sample).as_signed(), -300);
    EXPECT_EQ(to_string(sut.read(2, sample)), "abc");
    EXPECT_EQ(sut.index_of("b"), 1U);
    EXPECT_FALSE(sut.index_of("c"));
}

} // namespace
} // namespace gridspace::iec61850
