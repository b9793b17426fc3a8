// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/sample_json.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using testing::HasSubstr;

/// Little-endian CDR with its header.
std::vector<std::byte> cdr(std::initializer_list<int> octets) {
    std::vector<std::byte> out{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    for (int const v : octets) {
        out.push_back(static_cast<std::byte>(v));
    }
    return out;
}

TEST(SampleJson, KnowsTheKeyOfANestedStruct) {
    char const* const idl = "struct Inner { @key octet a; octet b; }; struct Whole { octet c; octet d[2]; };\n"
                            "struct Outer { @key Inner in2; octet inner; @key Whole all; octet v; };";
    auto const said = sample_to_json(idl, "Outer", cdr({1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(said["key"], "1/4/5/6");
    EXPECT_EQ(said["fields"]["v"], 7);
}

TEST(SampleJson, ReadsEnumsAsWideAsTheirBitBoundSays) {
    char const* const idl = "@bit_bound(8) enum Small { A, B };\n@bit_bound(16) enum Middle { C, @value(300) D };\n"
                            "enum Wide { E, F };\nstruct S { @key Small s; @key Middle m; Wide w; octet v; };";
    auto const said = sample_to_json(idl, "S", cdr({1, 0, 0x2c, 1, 1, 0, 0, 0, 9}));
    EXPECT_EQ(said["fields"], nlohmann::ordered_json::parse(R"({"s":"B","m":"D","w":"F","v":9})"));
    EXPECT_EQ(said["key"], "1/300");
}

TEST(SampleJson, NamesWhatItCannotDecodeAndDoesNotBlameTheSample) {
    char const* const idl = "#pragma once\n#define LENGTH 2\n#include <far.idl>\n"
                            "union U switch (long) { case 1: long a; case 2: struct { long b; } c; };\n"
                            "@bit_bound(8) bitmask M { @position(1) FIRST, SECOND };\n"
                            "bitset B { bitfield<3> a; };\n"
                            "struct HasUnion { sequence<U> us; };\n"
                            "struct HasWide { wstring<8> w; };\n"
                            "struct HasMap { map<string, sequence<long>> m; };\n"
                            "struct HasMask { M m; }; struct HasSet { B b; };\n"
                            "struct HasFar { far::Thing thing; };\n"
                            "@mutable struct Changing { long a; };\n"
                            "struct Maybe { @optional long a; };\n"
                            "struct Inherits : Maybe { long b; };\n"
                            "struct Good { octet a[LENGTH]; };\n";
    for (auto const& [type, why] :
         {std::pair{"HasUnion", "line 4: 'union' is not supported"},
          {"HasMask", "line 5: 'bitmask' is not supported"},
          {"HasSet", "line 6: 'bitset' is not supported"},
          {"HasWide", "line 8: 'wstring' is not supported"},
          {"HasMap", "line 9: 'map' is not supported"},
          {"HasFar", "line 11: the type 'far::Thing' is not known, and #include is not followed"},
          {"Changing", "line 12: @mutable is not supported"},
          {"Maybe", "line 13: @optional is not supported"},
          {"Inherits", "line 13: @optional is not supported"},
          {"U", "line 4: 'union' is not supported"}}) {
        EXPECT_EQ(sample_to_json(idl, type, cdr({1, 2, 3, 4, 5, 6, 7, 8}))["error"],
                  std::string{"samples of "} + type + " cannot be decoded: its IDL, " + why);
    }
    EXPECT_EQ(sample_to_json(idl, "Good", cdr({1, 2}))["fields"]["a[1]"], 2);
    EXPECT_THAT(sample_to_json("struct A {", "A", cdr({}))["error"].get<std::string>(), HasSubstr("line 1"));
}

} // namespace
} // namespace gridspace::monitor
