// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Frames that other decoders died of. What counts is that nothing is read outside of the frame (the buffers have
// exactly its size: run under AddressSanitizer), that decoding ends, and that the frame itself is not written to.
#include "hex.hpp"

#include <gmock/gmock.h>
#include <memory>
#include <random>

namespace gridspace::iec61850 {
namespace {

bool same(SvFrame const& a, SvFrame const& b) {
    return a.count == b.count && a.secured == b.secured &&
           std::equal(a.view().begin(), a.view().end(), b.view().begin(), [](Asdu const& x, Asdu const& y) {
               return x.sv_id == y.sv_id && x.dat_set == y.dat_set && x.sample.data() == y.sample.data() &&
                      x.sample.size() == y.sample.size() && x.refr_tm == y.refr_tm && x.gm_identity == y.gm_identity &&
                      x.conf_rev == y.conf_rev && x.smp_cnt == y.smp_cnt && x.smp_rate == y.smp_rate &&
                      x.smp_mod == y.smp_mod && x.fields == y.fields && x.smp_synch == y.smp_synch &&
                      x.offset == y.offset;
           });
}

/// Decodes a copy that ends where the frame ends.
template <class Frame>
DecodeError decode_exact(Octets frame) {
    auto const copy = std::make_unique<std::uint8_t[]>(frame.size());
    std::copy(frame.begin(), frame.end(), copy.get());
    auto sut = std::make_unique<Frame>();
    Decoded<void> result;
    if constexpr (std::is_same_v<Frame, SvFrame>) {
        result = decode_sv({copy.get(), frame.size()}, *sut);
        auto const slow = std::make_unique<SvFrame>();
        auto const again = decode_sv_without_shortcut({copy.get(), frame.size()}, *slow);
        EXPECT_EQ(again, result) << "the shortcut for usual frames decides otherwise";
        EXPECT_TRUE(!result || same(*sut, *slow)) << "the shortcut for usual frames reads something else";
    } else {
        result = decode_goose({copy.get(), frame.size()}, *sut);
    }
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), copy.get())) << "the decoder wrote into the frame";
    return result ? DecodeError{} : result.error();
}

DecodeError decode_both(Octets frame) {
    DecodeError const sv = decode_exact<SvFrame>(frame), goose = decode_exact<GooseFrame>(frame);
    return sv.reason == Reason::none                 ? sv
           : goose.reason == Reason::none            ? goose
           : goose.reason != Reason::other_ethertype ? goose
                                                     : sv;
}

std::vector<Buffer> seeds() {
    std::vector<Buffer> out{concat(addresses(), from_hex(kGoldenSv)), concat(addresses(), from_hex(kGoldenGoose))};
    GooseDescription rich = one_boolean();
    rich.data_set.members.clear();
    for (std::size_t i = 0; i < kBasicTypes; ++i) {
        auto const type = static_cast<BasicType>(i);
        rich.data_set.members.push_back({"s", DataNode::Kind::structure, {}, 0, {DataNode::leaf("x", type)}});
    }
    auto goose = GooseTemplate::create(sv_address(), rich);
    out.emplace_back(goose->frame({}).begin(), goose->frame({}).end());
    AsduDescription full = asdu("MU", 12);
    full.dat_set = "d";
    full.refr_tm = true;
    full.smp_rate = 80;
    full.gm_identity = 1;
    auto const sv = SvTemplate::create(sv_address(), {full, asdu("MU2", 4)});
    out.emplace_back(sv->frame().begin(), sv->frame().end());
    return out;
}

TEST(DamagedFrame, TheSeedsAreWhole) {
    for (Buffer const& seed : seeds()) {
        EXPECT_EQ(decode_both(seed).reason, Reason::none) << to_hex(seed);
    }
}

TEST(DamagedFrame, EveryPrefixIsRefusedAndTheWholeIsNot) {
    for (Buffer const& seed : seeds()) {
        for (std::size_t size = 0; size < seed.size(); ++size) {
            EXPECT_NE(decode_both(Octets{seed}.first(size)).reason, Reason::none) << size;
        }
        EXPECT_EQ(decode_both(seed).reason, Reason::none);
    }
}

TEST(DamagedFrame, EveryPrefixWithAMatchingLengthFieldIsHandled) {
    for (Buffer const& seed : seeds()) {
        for (std::size_t size = 26; size < seed.size(); ++size) {
            Buffer cut{seed.begin(), seed.begin() + static_cast<std::ptrdiff_t>(size)};
            store_be(cut.data() + 20, static_cast<std::uint16_t>(size - 18));
            EXPECT_NE(decode_both(cut).reason, Reason::none) << size;
        }
    }
}

TEST(DamagedFrame, EveryOctetWithEveryValueIsHandled) {
    for (Buffer const& seed : seeds()) {
        for (std::size_t at = 12; at < seed.size(); ++at) {
            Buffer changed = seed;
            for (unsigned value = 0; value < 256; value += at < 40 ? 1 : 7) {
                changed[at] = static_cast<std::uint8_t>(value);
                decode_both(changed);
            }
        }
    }
}

TEST(DamagedFrame, EveryTagWithEveryLengthIsHandledAsData) {
    for (unsigned tag = 0; tag < 256; ++tag) {
        for (std::size_t length = 0; length <= 20; ++length) {
            Buffer octets(2 + length, 0x83);
            octets[0] = static_cast<std::uint8_t>(tag);
            octets[1] = static_cast<std::uint8_t>(length);
            auto const exact = std::make_unique<std::uint8_t[]>(octets.size());
            std::copy(octets.begin(), octets.end(), exact.get());
            Octets const data{exact.get(), octets.size()};
            (void)check_data(data, 0);
            BerCursor cursor{data, 0};
            Tlv e;
            if (cursor.next(e) == Reason::none) {
                for (std::size_t type = 0; type < kBasicTypes; ++type) {
                    (void)read_data_value(e, static_cast<BasicType>(type));
                }
                if (auto const value = read_any_data_value(e)) {
                    (void)to_string(*value);
                }
            }
        }
    }
}

TEST(DamagedFrame, ForbiddenLengthFormsAreRefused) {
    for (std::string_view const form :
         {"80", "85", "ff", "8400000000ff", "847fffffff", "84ffffffff", "81", "82ff", "83ffff"}) {
        Buffer const data = concat(from_hex("8a"), from_hex(form));
        auto const result = check_data(data, 100);
        EXPECT_FALSE(result) << form;
        EXPECT_GE(result.error().offset, 100U) << form;
    }
    EXPECT_TRUE(check_data(from_hex("8a8400000001 41"), 0))
        << "long forms are allowed, even when they are not the shortest";
    EXPECT_TRUE(check_data(concat(from_hex("8a7f"), Buffer(127, 0x41)), 0)) << "a short form of 127";
    EXPECT_TRUE(check_data(concat(from_hex("8a8180"), Buffer(128, 0x41)), 0));
}

TEST(DamagedFrame, RandomOctetsBehindAValidHeaderAreHandled) {
    std::mt19937 random{1};
    for (int i = 0; i < 20'000; ++i) {
        Buffer frame = concat(addresses(), from_hex(i % 2 == 0 ? "88b8 0001" : "88ba 4000"));
        std::size_t const size = random() % 64;
        frame = concat(frame, {0, static_cast<std::uint8_t>(8 + size), 0, 0, 0, 0});
        for (std::size_t k = 0; k < size; ++k) {
            constexpr std::uint8_t kLikely[] = {0x60, 0x61, 0xA2, 0x30, 0x80, 0x82, 0x84, 0xAB, 0x1F, 0xFF, 0x02, 0x05};
            frame.push_back(random() % 2 == 0 ? kLikely[random() % std::size(kLikely)]
                                              : static_cast<std::uint8_t>(random()));
        }
        EXPECT_NE(decode_both(frame).reason, Reason::none);
    }
}

TEST(DamagedFrame, VlanTagsMayBeNoneOneOrTwoButNotMore) {
    Buffer const seed = seeds()[0];
    for (std::size_t tags = 0; tags < 4; ++tags) {
        Buffer frame = addresses();
        for (std::size_t i = 0; i < tags; ++i) {
            frame = concat(frame, from_hex(i == 0 && tags == 2 ? "88a80064" : "8100a001"));
        }
        frame.insert(frame.end(), seed.begin() + 16, seed.end());
        EXPECT_EQ(decode_both(frame).reason, tags < 3 ? Reason::none : Reason::other_ethertype) << tags;
        EXPECT_EQ(ethertype_of(frame), tags < 3 ? kSvEthertype : 0) << tags;
    }
}

TEST(DamagedFrame, ErrorsAreCountedByReason) {
    DecodeCounters sut;
    sut.count(Reason::truncated);
    sut.count(Reason::truncated);
    sut.count(Reason::too_many);
    EXPECT_EQ(sut.total(), 3U);
    EXPECT_EQ(sut.by_reason[static_cast<std::size_t>(Reason::truncated)], 2U);
    EXPECT_EQ(reason_name(Reason::too_many), "too_many");
}

} // namespace
} // namespace gridspace::iec61850
