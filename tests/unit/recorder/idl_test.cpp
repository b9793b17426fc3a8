// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/cdr_visitor.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <map>

namespace gridspace::idl {
namespace {

/// A CDR stream made by hand, octet by octet, as CORBA 3.0 15.3.1 lays it out.
std::vector<std::byte> octets(std::initializer_list<int> list) {
    std::vector<std::byte> out;
    for (int const v : list) {
        out.push_back(static_cast<std::byte>(v));
    }
    return out;
}

struct Collect final : Visitor {
    void leaf(std::string_view path, Type const&, Value const& value) override {
        leaves[std::string{path}] = to_text(value);
    }
    void sequence(std::string_view path, std::size_t length) override { lengths[std::string{path}] = length; }
    std::map<std::string, std::string> leaves;
    std::map<std::string, std::size_t> lengths;
};

TEST(Idl, ReadsTheConstructsOfOurInterfaces) {
    auto const sut =
        parse("// c\nconst unsigned long N = 4; /* x */\nmodule m { enum E { A, @value(7) B, C };\n"
              "@final struct S { @key string<16> id; sequence<double, N> v; long a[2][3]; E e; };\n"
              "typedef sequence<octet> Bytes; struct T : S { Bytes raw; unsigned long long n; boolean ok; }; };\n");
    ASSERT_TRUE(sut) << sut.error().message;
    auto const s = sut->find("m::S"), t = sut->find("m::T"), e = sut->find("m::E");
    ASSERT_TRUE(s && t && e);
    EXPECT_TRUE(sut->is_keyed(*s));
    EXPECT_EQ(sut->types[*e].values, (std::vector<std::pair<std::string, std::int32_t>>{{"A", 0}, {"B", 7}, {"C", 8}}));
    EXPECT_EQ(sut->types[*t].members.size(), 7U); // inherited ones first
    EXPECT_EQ(sut->types[*t].members.front().name, "id");
    EXPECT_EQ(sut->types[sut->types[*s].members[1].type].bound, 4U);
    Type const& outer = sut->types[sut->types[*s].members[2].type];
    EXPECT_EQ(outer.bound, 2U);
    EXPECT_EQ(sut->types[outer.element].bound, 3U);
}

TEST(Idl, MistakesNameTheirLine) {
    for (auto const& [text, line, word] : {std::tuple{"struct A {\n  Unknown x;\n};", "line 2", "Unknown"},
                                           {"struct A {\n  long x\n};", "line 3", ";"},
                                           {"struct A { long x; };\nstruct A { long y; };", "line 2", "twice"},
                                           {"module m {\n", "line 2", "not closed"},
                                           {"union U switch (long) { case 1: long a; };", "line 1", "union"}}) {
        auto const sut = parse(text);
        ASSERT_FALSE(sut) << text;
        EXPECT_NE(sut.error().message.find(line), std::string::npos) << sut.error().message;
        EXPECT_NE(sut.error().message.find(word), std::string::npos) << sut.error().message;
    }
}

TEST(Idl, NestingCannotOverflowTheStack) {
    std::string sequences = "struct A { ", modules;
    for (int i = 0; i < 100'000; ++i) {
        sequences += "sequence<";
        modules += "module a { ";
    }
    EXPECT_FALSE(parse(sequences));
    EXPECT_FALSE(parse(modules));
}

TEST(Cdr, IsReadWithItsAlignmentInBothByteOrders) {
    auto const model = parse("struct S { octet o; long long n; string s; sequence<short> v; boolean b; double d; };");
    ASSERT_TRUE(model);
    auto const little = octets(
        {0,       1, 0, 0, /*o*/ 9, 0,   0, 0, 0,       0, 0, 0, /*n*/ 0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,
         /*s*/ 3, 0, 0, 0, 'h',     'i', 0, 0, /*v*/ 2, 0, 0, 0, 1,          0,    0xff, 0xff,
         /*b*/ 1, 0, 0, 0, 0,       0,   0, 0, /*d*/ 0, 0, 0, 0, 0,          0,    0xf8, 0x3f});
    auto const big = octets({0,    0,    0, 0, 9, 0, 0,   0,   0,    0,    0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,
                             0xff, 0xfe, 0, 0, 0, 3, 'h', 'i', 0,    0,    0, 0, 0,    2,    0,    1,    0xff, 0xff,
                             1,    0,    0, 0, 0, 0, 0,   0,   0x3f, 0xf8, 0, 0, 0,    0,    0,    0});
    for (auto const& cdr : {little, big}) {
        Collect sut;
        auto const result = visit(*model, *model->find("S"), cdr, sut);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_EQ(
            sut.leaves,
            (std::map<std::string, std::string>{
                {"o", "9"}, {"n", "-2"}, {"s", "hi"}, {"v[0]", "1"}, {"v[1]", "-1"}, {"b", "true"}, {"d", "1.5"}}));
        EXPECT_EQ(sut.lengths.at("v"), 2U);
        EXPECT_EQ(find_integer(*model, *model->find("S"), cdr, "n"), -2);
        for (std::size_t size = 0; size < cdr.size(); ++size) { // cut anywhere, it is refused
            Collect ignored;
            EXPECT_FALSE(visit(*model, *model->find("S"), std::span{cdr}.first(size), ignored)) << size;
        }
    }
}

TEST(Cdr, LengthsThatCannotBeAreRefused) {
    auto const model =
        parse("struct S { sequence<octet, 3> v; }; struct T { sequence<octet> v; }; struct U { string s; };");
    ASSERT_TRUE(model);
    Collect sut;
    EXPECT_FALSE(
        visit(*model, *model->find("S"), octets({0, 1, 0, 0, 4, 0, 0, 0, 1, 2, 3, 4}), sut)); // above its bound
    EXPECT_FALSE(visit(*model, *model->find("T"), octets({0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 1}), sut));
    EXPECT_FALSE(
        visit(*model, *model->find("U"), octets({0, 1, 0, 0, 0, 0, 0, 0}), sut)); // a string has at least its NUL
    EXPECT_FALSE(visit(*model, *model->find("U"), octets({0, 7, 0, 0, 1, 0, 0, 0, 0}), sut)); // another encapsulation
}

TEST(Cdr, ArraysOfNothingEnd) {
    auto const model = parse("struct E {}; struct A { E a[16000000][16000000]; };");
    ASSERT_TRUE(model);
    Collect sut;
    EXPECT_FALSE(visit(*model, *model->find("A"), octets({0, 1, 0, 0}), sut));
}

} // namespace
} // namespace gridspace::idl
