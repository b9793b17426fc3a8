// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <random>
#include <zlib.h>

namespace gridspace::pcapng {
namespace {

using Octets = std::vector<std::uint8_t>;
constexpr std::int64_t kTime = 1'575'158'405'123'456'789;

class Pcapng : public testing::Test {
  protected:
    void SetUp() override {
        // In memory where possible: thousands of damaged files are slow on a disk.
        std::string pattern = (std::filesystem::exists("/dev/shm") ? "/dev/shm" : testing::TempDir()) +
                              std::string{"/gridspace-pcapng-XXXXXX"};
        folder_ = ::mkdtemp(pattern.data());
        file_ = folder_ / "capture.pcapng";
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write_example() const {
        auto sut = Writer::create(file_, "test");
        ASSERT_TRUE(sut);
        auto const a = sut->add_interface("process_bus", "mu21"), b = sut->add_interface("data_bus");
        ASSERT_TRUE(sut->write(a, kTime, Octets{1, 2, 3, 4, 5}, "t = 5.5 s", Direction::outbound));
        ASSERT_TRUE(sut->write(b, kTime + 1, Octets(64, 7)));
        ASSERT_TRUE(sut->statistics(a, kTime + 2, 10, 1));
        ASSERT_TRUE(sut->close());
    }
    [[nodiscard]] std::vector<char> content() const {
        std::ifstream in{file_, std::ios::binary};
        return {std::istreambuf_iterator<char>{in}, {}};
    }
    void put(std::vector<char> const& content) const {
        std::ofstream{file_, std::ios::binary}.write(content.data(), static_cast<std::streamsize>(content.size()));
    }

    std::filesystem::path folder_, file_;
};

TEST_F(Pcapng, KeepsNanosecondsInterfacesAndComments) {
    write_example();
    auto sut = Reader::open(file_);
    ASSERT_TRUE(sut);
    auto const first = sut->next();
    ASSERT_TRUE(first && *first);
    EXPECT_EQ((*first)->time_ns, kTime);
    EXPECT_EQ((*first)->octets, (Octets{1, 2, 3, 4, 5}));
    EXPECT_EQ((*first)->comment, "t = 5.5 s");
    EXPECT_EQ((*first)->direction, Direction::outbound);
    auto const second = sut->next();
    ASSERT_TRUE(second && *second);
    EXPECT_EQ((*second)->time_ns, kTime + 1);
    EXPECT_EQ(sut->interfaces().at((*second)->interface).name, "data_bus");
    EXPECT_EQ(sut->interfaces()[0].description, "mu21");
    auto const end = sut->next();
    ASSERT_TRUE(end);
    EXPECT_FALSE(*end);
    EXPECT_FALSE(sut->truncated());
}

TEST_F(Pcapng, GivesTheWholeFramesOfAFileThatWasCutOff) {
    write_example();
    auto const whole = content();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        put({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        auto sut = Reader::open(file_);
        if (!sut) {
            EXPECT_LT(size, 4U);
            continue;
        }
        std::size_t frames = 0;
        for (auto frame = sut->next(); frame && *frame; frame = sut->next()) {
            ++frames;
        }
        EXPECT_LE(frames, 2U);
    }
}

TEST_F(Pcapng, SurvivesDamage) {
    write_example();
    auto const whole = content();
    std::mt19937 random{1};
    for (int i = 0; i < 3000; ++i) {
        auto damaged = whole;
        for (int k = 0; k < 3; ++k) {
            damaged[random() % damaged.size()] = static_cast<char>(random());
        }
        put(damaged);
        auto sut = Reader::open(file_);
        for (int n = 0; sut && n < 10; ++n) {
            auto const frame = sut->next();
            if (!frame || !*frame) {
                break;
            }
        }
    }
}

/// Of a file that zlib's own reader has decompressed.
std::vector<char> decompressed(std::filesystem::path const& file) {
    gzFile const in = ::gzopen(file.c_str(), "rb");
    std::vector<char> out(16U << 20U);
    int const size = ::gzread(in, out.data(), static_cast<unsigned>(out.size()));
    EXPECT_EQ(::gzclose(in), Z_OK) << "it has its end and its checksum";
    out.resize(static_cast<std::size_t>(std::max(size, 0)));
    return out;
}

TEST_F(Pcapng, IsTheSameCaptureCompressedWhenItsNameSaysSo) {
    write_example();
    auto const plain = content();
    file_ = folder_ / "capture.pcapng.gz";
    write_example();
    auto const compressed = content();
    EXPECT_EQ(compressed[0], '\x1f');
    EXPECT_EQ(decompressed(file_), plain);

    auto sut = Reader::open(file_);
    ASSERT_TRUE(sut);
    std::vector<Octets> frames;
    ASSERT_TRUE(sut->each([&](Frame&& frame) { frames.push_back(std::move(frame.octets)); }));
    EXPECT_EQ(frames, (std::vector<Octets>{{1, 2, 3, 4, 5}, Octets(64, 7)}));
    EXPECT_FALSE(sut->truncated());
    write_example();
    EXPECT_EQ(content(), compressed) << "neither name nor date is in it";
}

/// What a recorder that was killed leaves: all frames but those of the last part.
TEST_F(Pcapng, IsReadableUpToTheLastPartWhenCompressedAndNeverClosed) {
    file_ = folder_ / "capture.pcapng.gz";
    constexpr std::size_t kFrames = 20'000, kOctetsOfAPart = 256U * 1024U, kBlock = 100 + 32;
    std::mt19937 random{1};
    auto writer = Writer::create(file_, "test");
    ASSERT_TRUE(writer);
    auto const interface = writer->add_interface("x");
    std::vector<Octets> written;
    for (std::size_t i = 0; i < kFrames; ++i) {
        written.emplace_back(100);
        std::generate(written.back().begin(), written.back().end(),
                      [&] { return static_cast<std::uint8_t>(random()); });
        ASSERT_TRUE(writer->write(interface, kTime, written.back()));
    }

    auto sut = Reader::open(file_);
    ASSERT_TRUE(sut);
    std::vector<Octets> read;
    ASSERT_TRUE(sut->each([&](Frame&& frame) { read.push_back(std::move(frame.octets)); }));

    EXPECT_TRUE(sut->truncated());
    EXPECT_GE(read.size(), kFrames - kOctetsOfAPart / kBlock - 1);
    written.resize(read.size());
    EXPECT_EQ(read, written);
}

TEST_F(Pcapng, GivesTheWholeFramesOfACompressedFileThatWasCutOffOrDamaged) {
    file_ = folder_ / "capture.pcapng.gz";
    write_example();
    auto const whole = content();
    std::mt19937 random{1};
    int refused = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
        put({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        auto sut = Reader::open(file_);
        std::size_t frames = 0;
        while (sut && frames < 10) {
            auto const frame = sut->next();
            if (!frame || !*frame) {
                break;
            }
            ++frames;
        }
        EXPECT_LE(frames, 2U);
        EXPECT_TRUE(!sut || sut->truncated()) << size;
    }
    for (int i = 0; i < 3000; ++i) {
        auto damaged = whole;
        damaged[10 + random() % (damaged.size() - 10)] = static_cast<char>(random());
        put(damaged);
        auto sut = Reader::open(file_);
        Result<void> done = sut ? sut->each([](Frame&&) {}) : Result<void>{std::unexpected{sut.error()}};
        refused += done ? 0 : 1;
    }
    EXPECT_GT(refused, 1000) << "what is compressed has a checksum";
}

TEST_F(Pcapng, OfAStrangerBecomesNeitherAnyNumberOfOctetsNorOfInterfaces) {
    auto const end_of = [&] {
        auto sut = Reader::open(file_);
        EXPECT_TRUE(sut);
        auto const done = sut->each([](Frame&&) {});
        return done ? std::string{"nothing"} : done.error().message;
    };
    auto writer = Writer::create(file_, "test");
    ASSERT_TRUE(writer);
    Octets const frame(8U << 20U);
    ASSERT_TRUE(writer->write(writer->add_interface("x"), kTime, frame));
    ASSERT_TRUE(writer->close());
    auto const one = content();
    file_ = folder_ / "capture.pcapng.gz";
    gzFile const out = ::gzopen(file_.c_str(), "wb9");
    constexpr std::size_t kBlock = (8U << 20U) + 32;
    ASSERT_EQ(::gzwrite(out, one.data(), static_cast<unsigned>(one.size())), static_cast<int>(one.size()));
    for (int i = 0; i < 45; ++i) { // 368 MiB become a third of one
        ASSERT_EQ(::gzwrite(out, one.data() + one.size() - kBlock, kBlock), static_cast<int>(kBlock));
    }
    ASSERT_EQ(::gzclose(out), Z_OK);
    EXPECT_THAT(end_of(), testing::HasSubstr("is too large: it becomes more than"));

    writer = Writer::create(file_, "test");
    ASSERT_TRUE(writer);
    for (int i = 0; i < 70'000; ++i) {
        (void)writer->add_interface("x");
    }
    ASSERT_TRUE(writer->close());
    EXPECT_THAT(end_of(), testing::HasSubstr("more than 65536 interfaces"));
}

TEST(CaptureOfARun, IsTheCompressedOneWhereThereIsOne) {
    auto const folder = std::filesystem::path{testing::TempDir()} / "gridspace_capture_of_a_run";
    std::filesystem::create_directories(folder);
    EXPECT_EQ(capture_of_run(folder), folder / "bus.pcapng");
    std::ofstream{folder / "bus.pcapng.gz"} << "x";
    EXPECT_EQ(capture_of_run(folder), folder / "bus.pcapng.gz");
    std::filesystem::remove_all(folder);
}

TEST_F(Pcapng, ReadsClassicCapturesOfEitherByteOrder) {
    for (bool const swapped : {false, true}) {
        for (bool const nano : {false, true}) {
            std::vector<char> file;
            auto const number = [&](std::uint32_t v) {
                v = swapped ? std::byteswap(v) : v;
                file.insert(file.end(), reinterpret_cast<char*>(&v), reinterpret_cast<char*>(&v) + 4);
            };
            number(nano ? 0xA1B23C4D : 0xA1B2C3D4);
            for (std::uint32_t const v : {swapped ? 0x00020004U : 0x00040002U, 0U, 0U, 65535U, 1U, 100U, 7U, 4U, 60U}) {
                number(v);
            }
            file.insert(file.end(), {1, 2, 3, 4});
            put(file);
            auto sut = Reader::open(file_);
            ASSERT_TRUE(sut) << describe(sut.error());
            auto const frame = sut->next();
            ASSERT_TRUE(frame && *frame);
            EXPECT_EQ((*frame)->time_ns, 100'000'000'000 + (nano ? 7 : 7000));
            EXPECT_EQ((*frame)->octets, (Octets{1, 2, 3, 4}));
            EXPECT_EQ((*frame)->original_octets, 60U);
            EXPECT_FALSE(*sut->next());
        }
    }
}

TEST_F(Pcapng, ReadsTheModifiedClassicCapture) { // A. Kuznetzov's, 0xa1b2cd34: eight octets more for each frame
    std::vector<char> file;
    for (std::uint32_t const v :
         {0xA1B2CD34U, 0x00040002U, 0U, 0U, 65535U, 1U, 100U, 7U, 4U, 60U, 3U, 0x00000800U, 0x04030201U}) {
        file.insert(file.end(), reinterpret_cast<char const*>(&v), reinterpret_cast<char const*>(&v) + 4);
    }
    put(file);
    auto sut = Reader::open(file_);
    ASSERT_TRUE(sut) << describe(sut.error());
    auto const frame = sut->next();
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->time_ns, 100'000'007'000);
    EXPECT_EQ((*frame)->octets, (Octets{1, 2, 3, 4}));
    EXPECT_FALSE(*sut->next());
}

TEST_F(Pcapng, ReadsPacketBlocksOfOldFiles) {
    write_example();
    auto file = content();
    auto const number = [&](auto v) {
        file.insert(file.end(), reinterpret_cast<char*>(&v), reinterpret_cast<char*>(&v) + sizeof v);
    };
    auto const units = static_cast<std::uint64_t>(kTime); // the writer counts nanoseconds
    number(std::uint32_t{2});
    number(std::uint32_t{44});
    number(std::uint16_t{1});      // interface
    number(std::uint16_t{0xFFFF}); // drops: not known
    number(static_cast<std::uint32_t>(units >> 32U));
    number(static_cast<std::uint32_t>(units));
    number(std::uint32_t{3});
    number(std::uint32_t{60});
    file.insert(file.end(), {7, 8, 9, 0, 2, 0, 4, 0, 2, 0, 0, 0}); // three octets and pack_flags: outbound
    number(std::uint32_t{44});
    put(file);
    auto sut = Reader::open(file_);
    ASSERT_TRUE(sut);
    ASSERT_TRUE(sut->next() && sut->next());
    auto const old = sut->next();
    ASSERT_TRUE(old && *old);
    EXPECT_EQ((*old)->octets, (Octets{7, 8, 9}));
    EXPECT_EQ((*old)->original_octets, 60U);
    EXPECT_EQ((*old)->time_ns, kTime);
    EXPECT_EQ(sut->interfaces().at((*old)->interface).name, "data_bus");
    EXPECT_EQ((*old)->direction, Direction::outbound);
    EXPECT_FALSE(*sut->next());
    EXPECT_FALSE(sut->truncated());
}

TEST_F(Pcapng, NamesWhatIsNoCaptureAndWhatIsNotThere) {
    EXPECT_THAT(Reader::open(folder_ / "none").error().message, testing::HasSubstr("No such file"));
    put({'P', 'K', 3, 4, 5, 6, 7, 8});
    EXPECT_THAT(Reader::open(file_).error().message, testing::HasSubstr("is not a capture"));
    EXPECT_THAT(Writer::create(folder_ / "none" / "x", "t").error().message, testing::HasSubstr("cannot write"));
}

TEST_F(Pcapng, SaysWhenTheDiskIsFull) {
    auto sut = Writer::create("/dev/full", "test");
    ASSERT_TRUE(sut);
    auto const interface = sut->add_interface("x");
    ASSERT_TRUE(sut->write(interface, 0, Octets(60)));
    auto const ok = sut->close();
    ASSERT_FALSE(ok);
    EXPECT_THAT(ok.error().message, testing::HasSubstr("No space left"));
}

TEST_F(Pcapng, WritesTheSameOctetsForTheSameFrames) {
    write_example();
    auto const once = content();
    write_example();
    EXPECT_EQ(content(), once);
}

} // namespace
} // namespace gridspace::pcapng
