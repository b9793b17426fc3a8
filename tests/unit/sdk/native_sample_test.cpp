// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/codec.hpp"
#include "common/idl/native_sample.hpp"
#include "sdk/topic_type.hpp"

#include <bus_gateway.h>
#include <ev_charging.h>
#include <gmock/gmock.h>
#include <limits>

namespace gridspace::idl {
namespace {

constexpr std::string_view kIdl = R"(
module station {
    enum Mode { OFF, @value(5) ON };
    struct Place { octet floor; double height_m; };
    @final struct Report {
        boolean valid;
        @key string<8> name;
        short count;
        Mode mode;
        Place places[2];
        sequence<double> curve;
        sequence<Place, 3> visited;
        sequence<string> notes;
        char grade;
        float ratio;
        unsigned long long total;
    };
};)";

// The same, written by hand: the compiler's layout is what is compared with.
struct Place {
    std::uint8_t floor;
    double height_m;
};
struct Report {
    bool valid;
    char const* name;
    std::int16_t count;
    std::int32_t mode;
    Place places[2];
    NativeSequence curve, visited, notes;
    char grade;
    float ratio;
    std::uint64_t total;
};

NativeLayout layout_of(std::string_view idl, std::string_view type) {
    return *NativeLayout::create(std::make_shared<Model const>(*parse(idl)), type);
}

std::vector<std::byte> encoded(NativeLayout const& layout, void const* sample) {
    std::vector<std::byte> out;
    auto const ok = encode(layout, sample, out);
    EXPECT_TRUE(ok) << ok.error().message;
    return out;
}

std::string refusal(NativeLayout const& layout, void const* sample) {
    std::vector<std::byte> out;
    auto const ok = encode(layout, sample, out);
    return ok ? "nothing" : ok.error().message;
}

struct ReportSample {
    std::array<double, 3> curve{1.5, -2, 1e300};
    std::array<Place, 2> visited{{{1, 3.5}, {2, 7}}};
    std::array<char const*, 2> notes{"first", "second one"};
    Report value{.valid = true,
                 .name = "north",
                 .count = -7,
                 .mode = 5,
                 .places = {{3, 1.25}, {4, 2.5}},
                 .curve = {3, curve.data()},
                 .visited = {2, visited.data()},
                 .notes = {2, notes.data()},
                 .grade = 'B',
                 .ratio = 0.5F,
                 .total = 1ULL << 40U};
};

TEST(NativeLayout, IsThatOfTheCompiler) {
    auto const sut = layout_of(kIdl, "station::Report");

    EXPECT_EQ(sut.size(), sizeof(Report));
    EXPECT_THAT(sut.place(sut.type()).offsets,
                testing::ElementsAre(offsetof(Report, valid), offsetof(Report, name), offsetof(Report, count),
                                     offsetof(Report, mode), offsetof(Report, places), offsetof(Report, curve),
                                     offsetof(Report, visited), offsetof(Report, notes), offsetof(Report, grade),
                                     offsetof(Report, ratio), offsetof(Report, total)));
}

TEST(NativeLayout, RefusesWhatHasNone) {
    auto const model = std::make_shared<Model const>(*parse("struct A { map<string, long> m; };", Unsupported::kept));

    EXPECT_FALSE(NativeLayout::create(model, "A"));
    EXPECT_THAT(NativeLayout::create(model, "B").error().message, testing::HasSubstr("no struct 'B'"));
}

TEST(NativeSample, ComesBackAsItWasSent) {
    auto const layout = layout_of(kIdl, "station::Report");
    ReportSample const sent;
    std::pmr::monotonic_buffer_resource memory;
    Report got{};

    auto const cdr = encoded(layout, &sent.value);
    ASSERT_TRUE(decode(layout, cdr, &got, memory));

    EXPECT_STREQ(got.name, "north");
    EXPECT_EQ(got.mode, 5);
    EXPECT_EQ(got.places[1].height_m, 2.5);
    EXPECT_EQ(static_cast<double const*>(got.curve.items)[2], 1e300);
    EXPECT_EQ(static_cast<Place const*>(got.visited.items)[1].floor, 2);
    EXPECT_STREQ(static_cast<char const* const*>(got.notes.items)[1], "second one");
    EXPECT_EQ(got.total, 1ULL << 40U);
    EXPECT_EQ(encoded(layout, &got), cdr);
}

TEST(NativeSample, HasTheOctetsOfTheGeneratedCode) {
    BusMeasurement measured;
    measured.bus("B1");
    measured.time_ns(360'000'000'000);
    measured.v_pu(0.97);
    for (char const* const name : {"EV1", "a longer name"}) {
        EvMeasurement ev;
        ev.ev(name);
        ev.soc_percent(42);
        ev.connected(true);
        measured.evs().push_back(ev);
    }
    bus::Codec const& codec = bus::codec_of<BusMeasurement>();
    std::vector<std::byte> theirs(4096);
    theirs.resize(codec.encode(&measured, theirs));
    auto const type = *sdk::TopicType::load("BusMeasurement", {});
    std::vector<std::max_align_t> struct_octets(type->layout().size() / sizeof(std::max_align_t) + 1);
    std::pmr::monotonic_buffer_resource memory;

    ASSERT_TRUE(decode(type->layout(), theirs, struct_octets.data(), memory));

    EXPECT_EQ(encoded(type->layout(), struct_octets.data()), theirs);
    bus::KeyHash key{};
    codec.key(&measured, key);
    EXPECT_EQ(type->key_hash(theirs), key);
}

TEST(NativeSample, NamesTheMemberThatCannotBeSent) {
    auto const layout = layout_of(kIdl, "station::Report");
    ReportSample sut;

    sut.visited[1].height_m = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.visited[1].height_m is nan, which is not finite");
    sut.visited[1].height_m = 0;
    sut.value.ratio = std::numeric_limits<float>::infinity();
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.ratio is inf, which is not finite");
    sut.value.ratio = 0;
    sut.value.name = "nine char";
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.name has 9 characters, and at most 8 fit");
    sut.value.name = nullptr;
    sut.value.mode = 1;
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.mode is 1, which is no value of station::Mode");
    sut.value.mode = 0;
    sut.value.visited.length = 4;
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.visited holds 4 items, and at most 3 fit");
    sut.value.visited = {1, nullptr};
    EXPECT_EQ(refusal(layout, &sut.value), "station::Report.visited says that it holds 1 items, and has none");
}

TEST(NativeSample, NothingIsReadBehindTheEndOfASampleThatIsCutOff) {
    auto const layout = layout_of(kIdl, "station::Report");
    ReportSample const sent;
    auto const cdr = encoded(layout, &sent.value);

    for (std::size_t length = 0; length < cdr.size(); ++length) {
        std::vector<std::byte> const cut{cdr.begin(), cdr.begin() + static_cast<std::ptrdiff_t>(length)};
        std::pmr::monotonic_buffer_resource memory;
        Report got{};
        EXPECT_FALSE(decode(layout, cut, &got, memory)) << length;
    }
}

TEST(NativeSample, ALengthThatCannotBeTrueCostsNoMemory) {
    auto const layout =
        layout_of("struct Block { octet octets[1000000]; }; struct S { sequence<Block> blocks; };", "S");
    std::array<std::byte, 12> cdr{};
    cdr[1] = std::byte{1};
    cdr[4] = std::byte{4}; // four blocks in the four octets that follow
    NativeSequence got{};

    EXPECT_FALSE(decode(layout, cdr, &got, *std::pmr::null_memory_resource()));
}

TEST(NativeSample, ReadsTheOtherOrderOfOctets) {
    auto const layout = layout_of("struct S { long n; sequence<short> m; };", "S");
    std::array<std::uint8_t, 16> const octets{0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 2, 0, 3, 0, 4};
    struct {
        std::int32_t n;
        NativeSequence m;
    } got{};
    std::pmr::monotonic_buffer_resource memory;

    ASSERT_TRUE(decode(layout, std::as_bytes(std::span{octets}), &got, memory));

    EXPECT_EQ(got.n, 258);
    EXPECT_EQ(static_cast<std::int16_t const*>(got.m.items)[1], 4);
}

} // namespace
} // namespace gridspace::idl
