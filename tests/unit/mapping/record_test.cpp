// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/constant.hpp"
#include "gateways/mapping/record_reader.hpp"
#include "gateways/mapping/record_writer.hpp"

#include <array>
#include <gmock/gmock.h>

namespace gridspace::mapping {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr char const* kIdl = R"(
module grid {
  enum Mode { IDLE, @value(5) RUN };
  @final struct Phase { float i; octet flags; };
  @final struct Feeder {
    @key string<8> name;
    long long time_ns;
    boolean closed;
    double v_kv[2];
    Mode mode;
    sequence<Phase, 3> phases;
    unsigned short tail;
  };
};)";

idl::Model model_of(char const* text) {
    auto model = idl::parse(text);
    EXPECT_TRUE(model.has_value());
    return *model;
}

std::vector<std::string> names(RecordType const& type) {
    std::vector<std::string> out;
    for (Field const& field : type.fields()) {
        out.push_back(field.name);
    }
    return out;
}

std::vector<std::byte> octets(std::initializer_list<int> values) {
    std::vector<std::byte> out;
    for (int const v : values) {
        out.push_back(static_cast<std::byte>(v));
    }
    return out;
}

// Written by hand by the rules of XCDR1: little endian, aligned from behind the header.
std::vector<std::byte> const kSample = octets({0, 1, 0, 0,                            //
                                               3, 0, 0, 0,    'F', '1', 0,    0,      // name, padding
                                               7, 0, 0, 0,    0,   0,   0,    0,      // time_ns
                                               1, 0, 0, 0,    0,   0,   0,    0,      // closed, padding
                                               0, 0, 0, 0,    0,   0,   0xF8, 0x3F,   // 1.5
                                               0, 0, 0, 0,    0,   0,   0xF0, 0xBF,   // -1
                                               5, 0, 0, 0,    1,   0,   0,    0,      // RUN, one phase
                                               0, 0, 0, 0x40, 9,   0,   0x34, 0x12}); // 2.0, 9, padding, tail

TEST(RecordType, NamesEveryBasicFieldOfAType) {
    auto const model = model_of(kIdl);
    auto const sut = RecordType::create(model, "grid::Feeder");
    ASSERT_TRUE(sut.has_value());
    EXPECT_THAT(names(*sut),
                ElementsAre("name", "time_ns", "closed", "v_kv.0", "v_kv.1", "mode", "phases.0.i", "phases.0.flags",
                            "phases.1.i", "phases.1.flags", "phases.2.i", "phases.2.flags", "tail"));
    EXPECT_EQ(sut->fields()[5].type, BasicType::enumerated);
    EXPECT_EQ(sut->enumerators(5)[1], (std::pair<std::string, std::int32_t>{"RUN", 5}));
    EXPECT_TRUE(sut->keyed());
    EXPECT_GE(sut->max_octets(), kSample.size());
}

TEST(RecordType, NamesTheElementsOfTheChosenSequenceWithoutAnIndex) {
    auto const model = model_of(kIdl);
    auto const sut = RecordType::create(model, "grid::Feeder", "phases");
    ASSERT_TRUE(sut.has_value());
    EXPECT_THAT(names(*sut), ElementsAre("name", "time_ns", "closed", "v_kv.0", "v_kv.1", "mode", "phases.i",
                                         "phases.flags", "tail"));
    EXPECT_EQ(sut->each_fields(), 2U);
    EXPECT_FALSE(RecordType::create(model, "grid::Feeder", "v_kv").has_value()) << "an array is not a sequence";
}

TEST(RecordType, SaysWhatCannotBeMapped) {
    auto const model = model_of(kIdl);
    auto const unknown = RecordType::create(model, "grid::Feder");
    ASSERT_FALSE(unknown.has_value());
    EXPECT_THAT(unknown.error().remedy, HasSubstr("grid::Feeder"));
    auto const large = model_of("struct Big { double a[200][200]; };");
    auto const refused = RecordType::create(large, "Big");
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message, HasSubstr("more than 16384 fields"));
}

TEST(RecordReader, ReadsASampleByTheRulesOfCdr) {
    auto const model = model_of(kIdl);
    auto const type = RecordType::create(model, "grid::Feeder");
    RecordReader sut{*type};
    std::vector<Value> values(type->fields().size(), Value::of(77.0));
    ASSERT_TRUE(sut.read(kSample, values));
    EXPECT_EQ(to_string(values[0]), "F1");
    EXPECT_EQ(values[1].as_signed(), 7);
    EXPECT_TRUE(values[2].boolean());
    EXPECT_EQ(values[3].number(), 1.5);
    EXPECT_EQ(values[4].number(), -1);
    EXPECT_EQ(values[5].as_signed(), 5);
    EXPECT_EQ(values[6].number(), 2.0);
    EXPECT_EQ(values[7].bits, 9U);
    EXPECT_EQ(values[8].number(), 0) << "an element that is not there is zero, and no old value";
    EXPECT_EQ(values[12].bits, 0x1234U);
}

TEST(RecordReader, RefusesEveryBeginningOfASampleAndStaysInside) {
    auto const model = model_of(kIdl);
    auto const type = RecordType::create(model, "grid::Feeder");
    RecordReader sut{*type};
    std::vector<Value> values(type->fields().size());
    for (std::size_t size = 0; size < kSample.size(); ++size) {
        std::vector<std::byte> const cut(kSample.begin(), kSample.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(sut.read(cut, values)) << size;
    }
    std::vector<std::byte> wrong = kSample;
    wrong[4] = std::byte{0xFF}; // the length of the name
    wrong[7] = std::byte{0xFF};
    EXPECT_FALSE(sut.read(wrong, values));
    wrong = kSample;
    wrong[48] = std::byte{4}; // more phases than the bound
    EXPECT_FALSE(sut.read(wrong, values));
    wrong = kSample;
    wrong[1] = std::byte{3}; // a parameter list, not plain CDR
    EXPECT_FALSE(sut.read(wrong, values));
}

TEST(RecordWriter, WritesTheOctetsThatItReads) {
    auto const model = model_of(kIdl);
    auto const type = RecordType::create(model, "grid::Feeder");
    RecordReader reader{*type};
    std::vector<std::size_t> const used{0, 1, 2, 3, 4, 5, 6, 7, 12};
    RecordWriter sut{*type, used};
    std::vector<Value> values(type->fields().size());
    ASSERT_TRUE(reader.read(kSample, values));
    std::copy(values.begin(), values.end(), sut.values().begin());
    auto const written = sut.write();
    EXPECT_THAT(std::vector<std::byte>(written.begin(), written.end()), testing::ElementsAreArray(kSample));
}

TEST(RecordWriter, MakesTheKeyAsDdsHashesIt) {
    auto const model =
        model_of("struct A { @key short a; float b; @key long long c; }; struct B { @key string<32> s; long x; };");
    auto const a = RecordType::create(model, "A");
    RecordWriter sut{*a, {0, 1, 2}};
    sut.values()[0] = Value::integer(BasicType::int16, 0x0102);
    sut.values()[2] = Value::integer(BasicType::int64, 3);
    auto const key = sut.write_key();
    EXPECT_THAT(std::vector<std::byte>(key.begin(), key.end()),
                testing::ElementsAreArray(octets({1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3})));
    EXPECT_TRUE(sut.key_is_short());
    auto const b = RecordType::create(model, "B");
    RecordWriter text{*b, {0}};
    text.values()[0] = Value::visible("ab");
    auto const text_key = text.write_key();
    EXPECT_THAT(std::vector<std::byte>(text_key.begin(), text_key.end()),
                testing::ElementsAreArray(octets({0, 0, 0, 3, 'a', 'b', 0})));
    EXPECT_FALSE(text.key_is_short());
}

TEST(RecordWriter, GathersElementsUpToItsCapacity) {
    auto const model = model_of(
        "struct S { float v; octet q; }; struct M { unsigned long long first; sequence<S, 8> samples; octet end; };");
    auto const type = RecordType::create(model, "M", "samples");
    RecordWriter sut{*type, {0, 1, 2, 3}, 2};
    sut.values()[0] = {BasicType::uint64, 0, 40, {}};
    sut.values()[1] = Value::of(1.0F);
    EXPECT_TRUE(sut.append());
    sut.values()[1] = Value::of(2.0F);
    sut.values()[2] = {BasicType::uint8, 0, 7, {}};
    EXPECT_TRUE(sut.append());
    EXPECT_FALSE(sut.append()) << "it holds two";
    auto const written = sut.write();
    RecordReader reader{*type};
    std::vector<Value> values(type->fields().size());
    ASSERT_TRUE(reader.read(written, values));
    EXPECT_EQ(values[0].bits, 40U);
    ASSERT_EQ(reader.elements(), 2U);
    ASSERT_TRUE(reader.next(values));
    EXPECT_EQ(values[1].number(), 1.0);
    ASSERT_TRUE(reader.next(values));
    EXPECT_EQ(values[1].number(), 2.0);
    EXPECT_EQ(values[2].bits, 7U);
    EXPECT_FALSE(reader.next(values));
}

TEST(RecordWriter, CutsATextAtItsBound) {
    auto const model = model_of("struct T { string<3> s; octet x; };");
    auto const type = RecordType::create(model, "T");
    RecordWriter sut{*type, {0, 1}};
    sut.values()[0] = Value::visible("abcdef");
    auto const written = sut.write();
    EXPECT_THAT(std::vector<std::byte>(written.begin(), written.end()),
                testing::ElementsAreArray(octets({0, 1, 0, 0, 4, 0, 0, 0, 'a', 'b', 'c', 0, 0})));
}

TEST(Constant, IsReadInTheTypeOfItsField) {
    Field const i8{"a", BasicType::int8, 0, {}};
    EXPECT_EQ(parse_constant("-128", i8)->as_signed(), -128);
    EXPECT_FALSE(parse_constant("128", i8).has_value());
    EXPECT_FALSE(parse_constant("1.5", i8).has_value());
    EXPECT_FALSE(parse_constant("", i8).has_value());
    EXPECT_EQ(parse_constant("0xFFFFFFFFFFFFFFFF", {"a", BasicType::uint64, 0, {}})->bits, ~std::uint64_t{0});
    EXPECT_FALSE(parse_constant("-1", {"a", BasicType::uint64, 0, {}}).has_value());
    EXPECT_EQ(parse_constant("invalid | test", {"q", BasicType::quality, 0, {}})->bits, 0x802U);
    EXPECT_FALSE(parse_constant("bad", {"q", BasicType::quality, 0, {}}).has_value());
    EXPECT_EQ(parse_constant("questionable | derived", {"q", BasicType::quality, 0, {}})->bits, 0x2003U);
    EXPECT_EQ(parse_constant("overflow|out_of_range|bad_reference|oscillatory|failure|old_data|inconsistent|inaccurate|"
                             "substituted|test|operator_blocked",
                             {"q", BasicType::quality, 13, {}})
                  ->bits,
              0x1FFCU);
    EXPECT_EQ(parse_constant("0x3fff", {"q", BasicType::quality, 0, {}})->bits, 0x3FFFU);
    for (char const* text : {"derived", "0x2003", "0x2000"}) {
        EXPECT_FALSE(parse_constant(text, {"q", BasicType::quality, 13, {}}).has_value()) << text << " in GOOSE";
    }
    EXPECT_THAT(expected_constant({"q", BasicType::quality, 13, {}}),
                testing::AllOf(testing::HasSubstr("up to 0x1fff"), testing::HasSubstr("no bit for 'derived'")));
    EXPECT_EQ(parse_constant("closed", {"p", BasicType::position, 0, {}})->bits, 2U);
    EXPECT_EQ(parse_constant("1e3", {"f", BasicType::float32, 0, {}})->as_float(), 1000.0F);
    EXPECT_FALSE(parse_constant("nan", {"f", BasicType::float32, 0, {}}).has_value());
    std::vector<std::pair<std::string, std::int32_t>> const names{{"IDLE", 0}, {"RUN", 5}};
    EXPECT_EQ(parse_constant("RUN", {"e", BasicType::enumerated, 0, {}}, names)->as_signed(), 5);
    EXPECT_FALSE(parse_constant("5", {"e", BasicType::enumerated, 0, {}}, names).has_value()) << "by name";
    EXPECT_FALSE(parse_constant("abcd", {"s", BasicType::visible_string, 3, {}}).has_value());
}

TEST(Mapping, TurnsTheCodeOfAPositionIntoAPositionAndBack) {
    std::vector<Mistake> mistakes;
    Rule r;
    r.from = "a";
    r.to = "b";
    auto sut =
        Mapping::compile({r}, {{"a", BasicType::enumerated, 0, {}}}, {{"b", BasicType::position, 0, {}}}, mistakes);
    ASSERT_TRUE(mistakes.empty());
    Value in = Value::integer(BasicType::enumerated, 1), out;
    sut.apply(std::span{&in, 1}, std::span{&out, 1});
    EXPECT_EQ(to_string(out), "open");
    in = Value::integer(BasicType::enumerated, -4);
    sut.apply(std::span{&in, 1}, std::span{&out, 1});
    EXPECT_EQ(to_string(out), "bad");
    EXPECT_EQ(sut.counters().saturated, 1U);
    auto back =
        Mapping::compile({r}, {{"a", BasicType::position, 0, {}}}, {{"b", BasicType::enumerated, 0, {}}}, mistakes);
    ASSERT_TRUE(mistakes.empty());
    in = {BasicType::position, 0, 2, {}};
    back.apply(std::span{&in, 1}, std::span{&out, 1});
    EXPECT_EQ(out, Value::integer(BasicType::enumerated, 2));
}

} // namespace
} // namespace gridspace::mapping
