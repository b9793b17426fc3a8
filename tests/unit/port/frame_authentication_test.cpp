// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/key_file.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace gridspace::gateways {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000'000;

class KeyFileOnDisk : public testing::Test {
  protected:
    void SetUp() override {
        std::string folder = (std::filesystem::temp_directory_path() / "gridspace_keys_XXXXXX").string();
        ASSERT_NE(mkdtemp(folder.data()), nullptr);
        folder_ = folder;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    streams::StreamAuthentication file(std::string const& text, mode_t mode) {
        streams::StreamAuthentication out;
        out.key_file = folder_ / "bus.keys";
        std::ofstream{out.key_file} << text;
        EXPECT_EQ(chmod(out.key_file.c_str(), mode), 0);
        return out;
    }
    std::filesystem::path folder_;
};

constexpr char const* kLine = "1 000102030405060708090a0b0c0d0e0f\n";

TEST_F(KeyFileOnDisk, IsReadWhenItIsItsOwnersAlone) {
    EXPECT_TRUE(load_keys(file(kLine, 0600), std::nullopt));
}

TEST_F(KeyFileOnDisk, IsRefusedWhenOthersMayReadOrWriteIt) {
    for (mode_t const mode : {0640U, 0604U, 0620U, 0644U}) {
        auto const sut = load_keys(file(kLine, mode), std::nullopt);
        ASSERT_FALSE(sut);
        EXPECT_NE(sut.error().message.find("others may read or write it"), std::string::npos);
        EXPECT_NE(sut.error().remedy.find("chmod 600"), std::string::npos);
    }
}

TEST_F(KeyFileOnDisk, IsRefusedWhenItIsMissingOrAFolder) {
    streams::StreamAuthentication sut;
    sut.key_file = folder_ / "none.keys";
    EXPECT_FALSE(load_keys(sut, std::nullopt));
    sut.key_file = folder_;
    EXPECT_FALSE(load_keys(sut, std::nullopt));
}

streams::Stream stream(std::string const& name, std::uint16_t app_id, bool required) {
    streams::Stream out;
    out.name.name = name;
    out.address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:21");
    out.address.app_id = app_id;
    out.address.vlan = iec61850::VlanTag{};
    out.sv_id = name;
    out.data_set = iec61850::data_set_92le();
    out.authentication.emplace();
    out.authentication->key_name = "bus";
    out.authentication->required = required;
    return out;
}

std::vector<std::uint8_t> frame_of(streams::Stream const& s) {
    auto const made = s.sv_template(*iec61850::Mac::parse("02:47:53:00:00:01"));
    return {made->frame().begin(), made->frame().end()};
}

TEST(FrameAuthentication, IsNotThereWhenNoStreamAsksForIt) {
    streams::Stream plain = stream("A", 0x4001, true);
    plain.authentication.reset();
    auto const sut = FrameAuthentication::create({plain}, std::nullopt);
    ASSERT_TRUE(sut);
    EXPECT_EQ(*sut, nullptr);
}

TEST(FrameAuthentication, RefusesWhatIsRequiredAndReportsWhatIsNot) {
    auto const strict = stream("A", 0x4001, true), lenient = stream("B", 0x4002, false);
    streams::Stream plain = stream("C", 0x4003, false);
    plain.authentication.reset();
    auto sender = std::move(*FrameAuthentication::create({strict, lenient, plain}, std::nullopt));
    auto sut = std::move(*FrameAuthentication::create({strict, lenient, plain}, std::nullopt));
    std::vector<std::string> told;
    sut->on_finding([&](std::string const& name, std::uint32_t findings, iec61850::Mac const&, SimTime) {
        told.push_back(name + ": " + authenticity_names(findings));
    });
    for (streams::Stream const* const s : std::array<streams::Stream const*, 3>{&strict, &lenient, &plain}) {
        auto const frame = frame_of(*s);
        EXPECT_EQ(sut->accept(frame, kNow, {}), s != &strict); // nobody's code
        std::vector<std::uint8_t> buffer;
        auto const sent = sender->sign(frame, kNow, buffer);
        EXPECT_EQ(sent.size() == frame.size(), s == &plain);
        EXPECT_TRUE(sut->accept(sent, kNow, {}));
    }
    EXPECT_EQ(told, (std::vector<std::string>{"A: untagged", "B: untagged"}));
    EXPECT_EQ((*sut->counters("A"))[static_cast<std::size_t>(iec61850::Authenticity::genuine)], 1U);
    EXPECT_EQ((*sut->counters("A"))[static_cast<std::size_t>(iec61850::Authenticity::untagged)], 1U);
    EXPECT_EQ(sut->counters("C"), nullptr);
}

TEST(FrameAuthentication, SignsForThreadsThatSendBesideEachOther) {
    auto const a = stream("A", 0x4001, true), b = stream("B", 0x4002, true);
    auto sut = std::move(*FrameAuthentication::create({a, b}, std::nullopt));
    std::array<std::vector<std::vector<std::uint8_t>>, 2> sent;
    auto const send = [&](std::size_t which) {
        auto const frame = frame_of(which == 0 ? a : b);
        for (int i = 0; i < 2000; ++i) {
            std::vector<std::uint8_t> buffer;
            (void)sut->sign(frame, kNow, buffer);
            sent[which].push_back(std::move(buffer));
        }
    };
    std::thread other{send, 1};
    send(0);
    other.join();
    std::set<std::vector<std::uint8_t>> vectors;
    for (auto const& frames : sent) {
        for (auto const& frame : frames) {
            EXPECT_TRUE(sut->accept(frame, kNow, {}));
            std::size_t const end = frame.size() - iec61850::extension_octets(a.authentication->algorithm);
            vectors.insert({frame.begin() + static_cast<std::ptrdiff_t>(end + 9),
                            frame.begin() + static_cast<std::ptrdiff_t>(end + 21)});
        }
    }
    EXPECT_EQ(vectors.size(), 4000U) << "one is used twice with the same key";
}

TEST(FrameAuthentication, AFrameOfOneStreamIsNotGenuineInAnotherOfTheSameKey) {
    auto const a = stream("A", 0x4001, true), b = stream("B", 0x4002, true);
    auto sut = std::move(*FrameAuthentication::create({a, b}, std::nullopt));
    std::vector<std::uint8_t> buffer;
    auto const sent = sut->sign(frame_of(a), kNow, buffer);
    std::vector<std::uint8_t> moved{sent.begin(), sent.end()};
    moved[19] = 2; // the APPID behind the VLAN tag
    EXPECT_FALSE(sut->accept(moved, kNow, {}));
    EXPECT_TRUE(sut->accept(sent, kNow, {}));
}

} // namespace
} // namespace gridspace::gateways
