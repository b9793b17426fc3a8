// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/codec.hpp"
#include "bus/key_hash.hpp"
#include "bus/topics.hpp"
#include "common/idl/key.hpp"

#include <bus_gateway.h>
#include <catalog.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <statistics.h>

namespace gridspace::idl {
namespace {

/// What the code that fastddsgen generated says of the same sample.
template <class T>
bus::KeyHash generated_hash(T const& sample) {
    bus::KeyHash hash{};
    bus::codec_of<T>().key(&sample, hash);
    return hash;
}

template <class T>
bus::KeyHash found_hash(T const& sample) {
    bus::Codec const& codec = bus::codec_of<T>();
    std::vector<std::byte> cdr(codec.encoded_size(&sample));
    cdr.resize(codec.encode(&sample, cdr));
    auto const model = parse(bus::idl_of_type(codec.type_name));
    EXPECT_TRUE(model.has_value());
    KeyFinder const sut{*model, *model->find(codec.type_name)};
    auto const key = sut.key_of(cdr);
    EXPECT_TRUE(key.has_value());
    return bus::key_hash(*key, sut.is_short());
}

TEST(KeyFinder, AgreesWithGeneratedCodeOnALongKey) {
    BusMeasurement sample;
    sample.bus("B17");
    sample.v_pu(0.98);
    EXPECT_EQ(found_hash(sample), generated_hash(sample));
}

TEST(KeyFinder, AgreesWithGeneratedCodeOnAKeyOfSeveralMembers) {
    StreamStatistics sample;
    sample.process("mu21"); // five octets with its end: the second member's length is padded
    sample.stream("SMV21");
    EXPECT_EQ(found_hash(sample), generated_hash(sample));
    StreamStatistics other = sample;
    other.stream("SMV22");
    EXPECT_NE(found_hash(sample), found_hash(other));
}

std::vector<std::byte> octets(std::initializer_list<int> list) {
    std::vector<std::byte> out;
    for (int const v : list) {
        out.push_back(static_cast<std::byte>(v));
    }
    return out;
}

TEST(KeyFinder, AShortKeyIsItsOctetsInBigEndian) {
    auto const model = parse("struct P { @key short x; @key long y; };\n"
                             "@final struct S { double before; @key P at; @key octet n; string rest; };");
    ASSERT_TRUE(model) << model.error().message;
    KeyFinder const sut{*model, *model->find("S")};
    EXPECT_TRUE(sut.is_short());
    auto const key = sut.key_of(octets({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // 0.0
                                        2, 1, 0, 0, 4, 3, 2, 1,             // x = 0x102, y = 0x1020304
                                        9, 0, 0, 0, 1, 0, 0, 0, 0}));       // n = 9, rest = ""
    ASSERT_TRUE(key) << key.error().message;
    EXPECT_EQ(*key, octets({1, 2, 0, 0, 1, 2, 3, 4, 9}));
}

TEST(KeyFinder, AKeyWithoutABoundIsNeverShort) {
    auto const model = parse("@final struct S { @key string id; }; @final struct Q { @key sequence<octet, 12> id; };"
                             "@final struct R { @key sequence<octet, 13> id; };");
    ASSERT_TRUE(model);
    EXPECT_FALSE((KeyFinder{*model, *model->find("S")}.is_short()));
    EXPECT_TRUE((KeyFinder{*model, *model->find("Q")}.is_short()));
    EXPECT_FALSE((KeyFinder{*model, *model->find("R")}.is_short()));
}

TEST(KeyFinder, AKeyThatGrowsWithEachStructIsNotFollowedToItsEnd) {
    std::string keys = "struct L0 { @key long a, b, c, d; };\n", nothing = "struct E0 {};\n";
    for (int i = 1; i <= 16; ++i) {
        keys += fmt::format("struct L{} {{ @key L{} a, b, c, d; }};\n", i, i - 1);
        nothing += fmt::format("struct E{} {{ E{} a, b, c, d; }};\n", i, i - 1);
    }
    auto const model = parse(keys + nothing + "struct T { @key E14 a; @key long b; };");
    ASSERT_TRUE(model) << model.error().message;
    KeyFinder const sut{*model, *model->find("L16")};
    EXPECT_FALSE(sut.is_short());
    EXPECT_FALSE(sut.covers("a.a"));
    auto const key = sut.key_of(octets({0, 1, 0, 0}));
    ASSERT_FALSE(key);
    EXPECT_NE(key.error().message.find("too many members"), std::string::npos) << key.error().message;
    EXPECT_FALSE((KeyFinder{*model, *model->find("T")}.is_short()));
}

TEST(KeyFinder, ASampleThatIsNotOfItsTypeHasNoKey) {
    auto const model = parse("@final struct S { @key long id; long rest; };");
    ASSERT_TRUE(model);
    EXPECT_FALSE((KeyFinder{*model, *model->find("S")}.key_of(octets({0, 1, 0, 0, 1, 0, 0, 0})).has_value()));
}

} // namespace
} // namespace gridspace::idl
