// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the encoder writes is what the decoder reads, for generated streams and values.
#include "hex.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace gridspace::iec61850 {
namespace {

std::string visible_text(std::size_t at_most) {
    auto const size = *rc::gen::inRange<std::size_t>(1, at_most + 1);
    return *rc::gen::container<std::string>(size, rc::gen::inRange<char>(0x20, 0x7F));
}

/// A value of `leaf`; texts keeps the characters.
Value any_value(Leaf const& leaf, std::vector<std::string>& texts) {
    auto const bits = *rc::gen::arbitrary<std::uint64_t>();
    switch (leaf.type) {
    case BasicType::boolean:
        return Value::of((bits & 1U) != 0);
    case BasicType::position:
        return {leaf.type, 0, bits & 3U, {}};
    case BasicType::quality:
        return Value::quality(static_cast<std::uint32_t>(bits & 0x1FFFU));
    case BasicType::bit_string:
        return {
            leaf.type, static_cast<std::uint8_t>(leaf.length), bits & (~std::uint64_t{0} >> (64U - leaf.length)), {}};
    case BasicType::float32:
        return {leaf.type, 0, bits & 0xFFFFFFFFU, {}};
    case BasicType::entry_time:
        return {leaf.type, 0, bits & 0xFFFFFFFFFFFFU, {}};
    case BasicType::visible_string:
    case BasicType::octet_string:
        texts.push_back(visible_text(leaf.length));
        return {leaf.type, 0, 0, octets_of(texts.back())};
    default:
        break;
    }
    if (is_integer(leaf.type)) {
        unsigned const width = static_cast<unsigned>(8 * integer_octets(leaf.type));
        unsigned const shift = static_cast<unsigned>(*rc::gen::inRange<unsigned>(64 - width, 64)); // small ones too
        return is_signed(leaf.type) ? Value::integer(leaf.type, static_cast<std::int64_t>(bits) >> shift)
                                    : Value{leaf.type, 0, bits >> shift, {}};
    }
    return {leaf.type, 0, bits, {}};
}

DataNode any_node(int depth) {
    auto const kind = *rc::gen::inRange(0, depth > 0 ? 5 : 3);
    std::string const name = "m";
    if (kind < 3) {
        auto const type = static_cast<BasicType>(*rc::gen::inRange<std::size_t>(0, kBasicTypes));
        return DataNode::leaf(
            name, type, type == BasicType::bit_string ? *rc::gen::inRange<std::uint16_t>(1, 65) : std::uint16_t{0});
    }
    DataNode out{name, kind == 3 ? DataNode::Kind::structure : DataNode::Kind::array, {}, 0, {}};
    for (int i = *rc::gen::inRange(0, 4); i-- > 0;) {
        out.members.push_back(any_node(depth - 1));
    }
    return out;
}

void goose_round_trip() {
    GooseDescription description = one_boolean();
    description.gocb_ref = visible_text(129);
    description.dat_set = visible_text(129);
    description.go_id = *rc::gen::arbitrary<bool>() ? visible_text(129) : "";
    description.conf_rev = *rc::gen::arbitrary<std::uint32_t>();
    description.integers = *rc::gen::element(IntegerForm::minimal, IntegerForm::fixed);
    description.data_set.members.clear();
    for (int i = *rc::gen::inRange(1, 8); i-- > 0;) {
        description.data_set.members.push_back(any_node(3));
    }
    RC_PRE(!leaves_of(description.data_set).empty());
    Address address = sv_address();
    if (*rc::gen::arbitrary<bool>()) {
        address.vlan.reset();
    }
    address.app_id = *rc::gen::arbitrary<std::uint16_t>();
    auto stream = GooseTemplate::create(address, description);
    RC_PRE(stream.has_value());
    for (int message = 0; message < 4; ++message) { // the first is written whole, the others are patched
        std::vector<std::string> texts;
        texts.reserve(stream->leaves().size());
        std::vector<Value> values;
        for (std::size_t i = 0; i < stream->leaves().size(); ++i) {
            values.push_back(any_value(stream->leaves()[i], texts));
            RC_ASSERT(stream->set(i, values.back()) != GooseTemplate::Stored::refused);
        }
        GooseState const state{
            *rc::gen::arbitrary<std::uint32_t>(), *rc::gen::arbitrary<std::uint32_t>(),
            *rc::gen::arbitrary<std::uint32_t>(), UtcTime::from_bits(*rc::gen::arbitrary<std::uint64_t>()),
            *rc::gen::arbitrary<bool>(),          *rc::gen::arbitrary<bool>()};
        GooseFrame sut;
        RC_ASSERT(decode_goose(stream->frame(state), sut).has_value());
        RC_ASSERT(sut.gocb_ref == description.gocb_ref);
        RC_ASSERT(sut.dat_set == description.dat_set);
        RC_ASSERT(sut.go_id == description.go_id);
        RC_ASSERT(sut.conf_rev == description.conf_rev);
        RC_ASSERT(sut.st_num == state.st_num);
        RC_ASSERT(sut.sq_num == state.sq_num);
        RC_ASSERT(sut.live_ms == state.live_ms);
        RC_ASSERT(sut.t == state.t);
        RC_ASSERT(sut.simulation == state.simulation);
        RC_ASSERT(sut.header.simulated() == state.simulation);
        RC_ASSERT(sut.nds_com == state.nds_com);
        RC_ASSERT(sut.header.vlan == address.vlan);
        RC_ASSERT(sut.entries == description.data_set.members.size());
        RC_ASSERT(sut.declared_entries == sut.entries);
        DataWalker walker{sut.all_data, sut.all_data_offset};
        Tlv element;
        std::size_t leaf = 0;
        while (walker.next(element)) {
            if (is_container(element.tag)) {
                continue;
            }
            RC_ASSERT(leaf < values.size());
            auto const read = read_data_value(element, values[leaf].type);
            RC_ASSERT(read.has_value());
            RC_ASSERT(*read == values[leaf]);
            ++leaf;
        }
        RC_ASSERT(leaf == values.size());
    }
}

void sv_round_trip() {
    std::vector<AsduDescription> asdus;
    for (int i = *rc::gen::inRange(1, 17); i-- > 0;) {
        AsduDescription a = asdu(visible_text(40), *rc::gen::inRange<std::size_t>(1, 200));
        a.dat_set = *rc::gen::arbitrary<bool>() ? visible_text(40) : "";
        a.conf_rev = *rc::gen::arbitrary<std::uint32_t>();
        a.smp_synch = *rc::gen::arbitrary<std::uint8_t>();
        a.refr_tm = *rc::gen::arbitrary<bool>();
        if (*rc::gen::arbitrary<bool>()) {
            a.smp_rate = *rc::gen::arbitrary<std::uint16_t>();
            a.smp_mod = SampleMode::per_second;
            a.gm_identity = *rc::gen::arbitrary<std::uint64_t>();
        }
        asdus.push_back(a);
    }
    auto stream = SvTemplate::create(sv_address(), asdus);
    RC_PRE(stream.has_value());
    std::vector<std::uint16_t> counters;
    for (std::size_t i = 0; i < asdus.size(); ++i) {
        counters.push_back(*rc::gen::arbitrary<std::uint16_t>());
        stream->set_smp_cnt(i, counters.back());
        for (std::uint8_t& octet : stream->sample(i)) {
            octet = static_cast<std::uint8_t>(counters.back() + i);
        }
        if (asdus[i].refr_tm) {
            stream->set_refr_tm(i, UtcTime{counters.back(), 5, 6});
        }
    }
    SvFrame sut;
    RC_ASSERT(decode_sv(stream->frame(), sut).has_value());
    RC_ASSERT(sut.count == asdus.size());
    for (std::size_t i = 0; i < asdus.size(); ++i) {
        Asdu const& a = sut.asdus[i];
        RC_ASSERT(a.sv_id == asdus[i].sv_id);
        RC_ASSERT(a.dat_set == asdus[i].dat_set);
        RC_ASSERT(a.conf_rev == asdus[i].conf_rev);
        RC_ASSERT(a.smp_synch == asdus[i].smp_synch);
        RC_ASSERT(a.smp_cnt == counters[i]);
        RC_ASSERT(a.has(Asdu::refr_tm_field) == asdus[i].refr_tm);
        RC_ASSERT(a.refr_tm.seconds == (asdus[i].refr_tm ? counters[i] : 0U));
        RC_ASSERT(a.smp_rate == asdus[i].smp_rate.value_or(0));
        RC_ASSERT(a.gm_identity == asdus[i].gm_identity.value_or(0));
        RC_ASSERT(a.sample.size() == asdus[i].sample_octets);
        RC_ASSERT(a.sample.back() == static_cast<std::uint8_t>(counters[i] + i));
    }
}

void sv_value_round_trip() {
    auto const type = static_cast<BasicType>(*rc::gen::inRange<std::size_t>(0, kBasicTypes));
    Leaf const leaf{"x", type, default_length(type)};
    std::vector<std::string> texts;
    Value const value = any_value(leaf, texts);
    std::vector<std::uint8_t> octets(sv_octets(type), 0xAA);
    write_sv_value(value, octets);
    Value const read = read_sv_value(type, octets);
    RC_ASSERT(read.bits == value.bits);
    RC_ASSERT(type == BasicType::octet_string || std::ranges::equal(read.text, value.text));
}

TEST(RoundTrip, GooseMessagesKeepEverything) {
    EXPECT_TRUE(rc::check(goose_round_trip));
}
TEST(RoundTrip, SampledValuesKeepEverything) {
    EXPECT_TRUE(rc::check(sv_round_trip));
}
TEST(RoundTrip, ValuesOfASampleKeepEverything) {
    EXPECT_TRUE(rc::check(sv_value_round_trip));
}

} // namespace
} // namespace gridspace::iec61850
