// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/mcap/mcap_index.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/mcap/mcap_writer.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <malloc.h>
#include <zstd.h>

namespace gridspace::mcap {
namespace {

/// A folder of the test's own.
class Recording : public ::testing::TestWithParam<bool> {
  protected:
    static std::vector<std::byte> sample(std::uint32_t n) {
        std::vector<std::byte> out(40 + n % 7, std::byte{0x5a});
        out[0] = static_cast<std::byte>(n & 0xff);
        out[1] = static_cast<std::byte>(n >> 8);
        return out;
    }

    /// `count` messages, alternately of two processes; flushed after each 500.
    void write(std::uint32_t count, bool close) const {
        auto sut = Writer::create(file_, {.compress = GetParam(), .chunk_octets = 4096});
        ASSERT_TRUE(sut) << sut.error().message;
        auto const schema = sut->add_schema("T", "omgidl", "struct T { long a; };");
        std::uint16_t const channels[] = {sut->add_channel(schema, "topic", "cdr", {{"process", "a"}}),
                                          sut->add_channel(schema, "topic", "cdr", {{"process", "b"}})};
        for (std::uint32_t n = 0; n < count; ++n) {
            ASSERT_TRUE(sut->write(channels[n % 2], n / 2 + 1, 1000 + n, sample(n)));
            if (n % 500 == 499) {
                ASSERT_TRUE(sut->flush());
            }
        }
        if (close) {
            ASSERT_TRUE(sut->close());
        } else {
            ASSERT_TRUE(sut->flush());
        }
    }

    struct Read {
        ReadOutcome outcome;
        std::uint32_t good{0}; ///< messages from the beginning that are as they were written
    };
    Read read() const {
        Read out;
        bool as_written = true;
        auto const outcome = read_messages(file_, [&](Message const& m) {
            std::uint32_t const n = out.good;
            as_written = as_written && m.channel.topic == "topic" && m.schema.name == "T" && m.sequence == n / 2 + 1 &&
                         m.time_ns == 1000 + n && m.channel.metadata.at("process") == (n % 2 == 0 ? "a" : "b") &&
                         std::ranges::equal(m.data, sample(n));
            out.good += as_written ? 1 : 0;
            return true;
        });
        EXPECT_TRUE(outcome) << outcome.error().message;
        out.outcome = outcome.value_or(ReadOutcome{});
        return out;
    }

    std::string bytes() const {
        std::ifstream stream{file_, std::ios::binary};
        return {std::istreambuf_iterator<char>{stream}, {}};
    }
    void put(std::string_view text) const { std::ofstream{file_, std::ios::binary | std::ios::trunc} << text; }

    TemporaryFolder temporary_;
    std::filesystem::path folder_{temporary_.path()}, file_{folder_ / "data.mcap"};
};

TEST_P(Recording, ReadsBackWhatWasWritten) {
    write(3000, true);
    Read const sut = read();
    EXPECT_EQ(sut.good, 3000U);
    EXPECT_EQ(sut.outcome.messages, 3000U);
    EXPECT_TRUE(sut.outcome.complete);
    EXPECT_EQ(sut.outcome.note, "");
}

TEST_P(Recording, WithoutItsEndIsReadAsFarAsItWasFlushedAndSaysSo) {
    write(1500, false);
    Read const sut = read();
    EXPECT_EQ(sut.good, 1500U);
    EXPECT_FALSE(sut.outcome.complete);
    EXPECT_NE(sut.outcome.note.find("did not finish"), std::string::npos) << sut.outcome.note;
}

TEST_P(Recording, CutAnywhereGivesItsBeginningAndNeverAnythingElse) {
    write(1000, true);
    std::string const whole = bytes();
    std::uint32_t before = 0;
    for (std::size_t size = 8; size < whole.size(); size += 97) {
        put(whole.substr(0, size));
        Read const sut = read();
        EXPECT_EQ(sut.good, sut.outcome.messages) << size; // every message that is given is as it was written
        EXPECT_GE(sut.good, before) << size;
        EXPECT_TRUE(sut.outcome.complete || !sut.outcome.note.empty()) << size;
        before = sut.good;
    }
    EXPECT_EQ(before, 1000U);
}

TEST_P(Recording, IsReadWhileItGrowsByWhateverPieces) {
    GrowingFile sut{file_};
    EXPECT_FALSE(sut.read_on([](Message const&) { return true; })) << "it is not there";
    std::filesystem::path const whole = file_.string() + ".whole";
    write(1200, true);
    std::filesystem::rename(file_, whole);
    std::ifstream from{whole, std::ios::binary};
    std::uint32_t good = 0, all = 0;
    std::uint64_t came_at_once = 0;
    for (std::vector<char> piece(1777); from.read(piece.data(), 1777), from.gcount() > 0;) {
        std::ofstream{file_, std::ios::binary | std::ios::app}.write(piece.data(), from.gcount());
        std::uint32_t const before = all;
        sut.read_on([&](Message const& m) {
            good += m.time_ns == 1000 + all && std::ranges::equal(m.data, sample(all)) ? 1 : 0;
            ++all;
            return true;
        });
        came_at_once = std::max<std::uint64_t>(came_at_once, all - before);
    }
    EXPECT_EQ(all, 1200U);
    EXPECT_EQ(good, 1200U);
    EXPECT_LT(came_at_once, 1200U) << "nothing was read while it grew";
    EXPECT_FALSE(sut.read_on([](Message const&) { return true; })) << "it has ended";
}

TEST_P(Recording, WithAFlippedBitNeverGivesAChangedMessage) {
    write(600, true);
    std::string const whole = bytes();
    for (std::size_t at = 8; at < whole.size() / 2; at += 61) { // chunks carry checksums
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        put(damaged);
        std::uint32_t wrong = 0;
        auto const outcome = read_messages(file_, [&](Message const& m) {
            if (m.time_ns >= 1000 && m.time_ns < 1600 && m.channel.topic == "topic") {
                wrong += std::ranges::equal(m.data, sample(static_cast<std::uint32_t>(m.time_ns - 1000))) ? 0 : 1;
            }
            return true;
        });
        (void)outcome;
        EXPECT_EQ(wrong, 0U) << "octet " << at;
    }
}

TEST_P(Recording, LosesOneChunkWhenOneIsDamagedAndSaysSo) {
    write(1000, true); // the first 500 and the others are in chunks of their own
    std::string damaged = bytes();
    auto const body_size = [&](std::size_t record) {
        std::uint64_t size = 0;
        std::memcpy(&size, &damaged[record + 1], sizeof size);
        return static_cast<std::size_t>(size);
    };
    std::size_t chunk = 8; // behind the magic
    while (damaged[chunk] != 6) {
        chunk += 9 + body_size(chunk);
    }
    std::size_t const near_its_end = chunk + 9 + body_size(chunk) - 5;
    damaged[near_its_end] = static_cast<char>(damaged[near_its_end] ^ 0x10);
    put(damaged);
    std::uint64_t last = 0, wrong = 0;
    auto const outcome = read_messages(file_, [&](Message const& m) {
        last = m.time_ns;
        wrong += std::ranges::equal(m.data, sample(static_cast<std::uint32_t>(m.time_ns - 1000))) ? 0 : 1;
        return true;
    });
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(last, 1999U); // what comes after it is there
    EXPECT_LT(outcome->messages, 1000U);
    EXPECT_FALSE(outcome->complete);
    EXPECT_NE(outcome->note.find("1 damaged chunk was left out"), std::string::npos) << outcome->note;
}

TEST_P(Recording, StopsWhenItsReaderHasEnough) {
    write(100, true);
    int seen = 0;
    auto const outcome = read_messages(file_, [&](Message const&) { return ++seen < 7; });
    ASSERT_TRUE(outcome);
    EXPECT_EQ(seen, 7);
    EXPECT_TRUE(outcome->complete);
}

TEST_P(Recording, ThatIsNotOneIsRefused) {
    put("not an mcap file");
    EXPECT_FALSE(read_messages(file_, [](Message const&) { return true; }));
    put("");
    EXPECT_FALSE(read_messages(file_, [](Message const&) { return true; }));
    EXPECT_FALSE(read_messages(folder_ / "none.mcap", [](Message const&) { return true; }));
}

TEST_P(Recording, ThatCannotBeWrittenSaysSo) {
    auto const sut = Writer::create("/dev/full", {.compress = GetParam(), .chunk_octets = 64});
    bool failed = !sut;
    if (sut) {
        auto& writer = const_cast<Writer&>(*sut);
        auto const schema = writer.add_schema("T", "omgidl", "");
        auto const channel = writer.add_channel(schema, "t", "cdr", {});
        failed = !writer.write(channel, 1, 1, std::vector<std::byte>(1000)) || !writer.flush() || !writer.close();
    }
    EXPECT_TRUE(failed);
}

TEST(LongRecording, MemoryDoesNotGrowWithItsLength) {
    TemporaryFolder const folder;
    std::filesystem::path const file = folder.path() / "long.mcap";
    constexpr std::uint32_t kChunks = 40'000; // of one message each: ten gigabytes of a real recording
    {
        auto sut = Writer::create(file, {.compress = false, .chunk_octets = 1});
        ASSERT_TRUE(sut);
        auto const channel = sut->add_channel(sut->add_schema("T", "omgidl", ""), "t", "cdr", {});
        std::size_t after_some = 0;
        for (std::uint32_t i = 0; i < kChunks; ++i) {
            ASSERT_TRUE(sut->write(channel, i, i, std::vector<std::byte>(4)));
            if (i == kChunks / 4) {
                after_some = ::mallinfo2().uordblks;
            }
        }
        EXPECT_LT(::mallinfo2().uordblks, after_some + 512 * 1024) << "the index of the rest alone is three megabytes";
        ASSERT_TRUE(sut->close());
    }
    std::uint32_t next = 0;
    auto const outcome = read_messages(file, [&](Message const& m) { return m.sequence == next++; });
    ASSERT_TRUE(outcome);
    EXPECT_TRUE(outcome->complete);
    EXPECT_EQ(next, kChunks);
}

INSTANTIATE_TEST_SUITE_P(Compressed, Recording, ::testing::Bool(),
                         [](auto const& p) { return p.param ? "zstd" : "plain"; });

/// Records as octets, by hand: what no writer of ours makes.
class Octets {
  public:
    template <class T>
    Octets& number(T value) {
        for (std::size_t i = 0; i < sizeof value; ++i) {
            text_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
        }
        return *this;
    }
    Octets& octets(std::string_view text) {
        text_ += text;
        return *this;
    }
    Octets& text(std::string_view text) { return number(static_cast<std::uint32_t>(text.size())).octets(text); }
    Octets& record(Op op, std::string_view body) {
        return number(static_cast<std::uint8_t>(op)).number(std::uint64_t{body.size()}).octets(body);
    }
    [[nodiscard]] std::string const& str() const { return text_; }

  private:
    std::string text_;
};

std::string const kHead{kMagic.begin(), kMagic.end()};

/// What reading a file of these octets says, and how many octets of memory it took at its peak.
struct Hostile : ::testing::Test {
    std::string note_of(std::string const& content) const {
        std::ofstream{file, std::ios::binary} << content;
        auto const outcome = read_messages(file, [](Message const&) { return true; });
        return outcome ? outcome->note : outcome.error().message;
    }
    TemporaryFolder const folder;
    std::filesystem::path const file{folder.path() / "x.mcap"};
};

TEST_F(Hostile, APromiseOfARecordTakesNoMemory) {
    std::string const promise = Octets{}.number(std::uint8_t{5}).number(std::uint64_t{200} << 20U).str();
    struct mallinfo2 const before = ::mallinfo2();
    EXPECT_EQ(note_of(kHead + promise + "xyz"), "the last record is cut: the recorder did not finish");
    EXPECT_LT(::mallinfo2().uordblks + ::mallinfo2().hblkhd, before.uordblks + before.hblkhd + (1U << 20U));
    EXPECT_NE(note_of(kHead + Octets{}.number(std::uint8_t{5}).number(std::uint64_t{1} << 40U).str())
                  .find("a record of 1099511627776 octets, more than 268435456"),
              std::string::npos);
}

std::string chunk(std::uint64_t promised, std::string_view stored) {
    return Octets{}
        .number(std::uint64_t{0})
        .number(std::uint64_t{0})
        .number(promised)
        .number(std::uint32_t{0})
        .text("zstd")
        .number(std::uint64_t{stored.size()})
        .octets(stored)
        .str();
}

TEST_F(Hostile, AChunkThatPromisesTooMuchIsNotDecompressed) {
    Octets sut;
    sut.octets(kHead).record(Op::chunk, chunk(std::uint64_t{65} << 20U, "")).record(Op::data_end, "0000");
    EXPECT_EQ(note_of(sut.str()), "1 damaged chunk was left out (a chunk of 68157440 octets, more than 67108864)");
}

TEST_F(Hostile, ManyChunksOfNothingAreNotDecompressedWithoutEnd) {
    std::string const nothing =
        Octets{}.record(Op{0x7F}, std::string((64U << 20U) - 9, '\0')).str(); // of a kind that nobody knows
    std::string packed(::ZSTD_compressBound(nothing.size()), '\0');
    packed.resize(::ZSTD_compress(packed.data(), packed.size(), nothing.data(), nothing.size(), 1));
    Octets sut;
    sut.octets(kHead);
    std::string const body = chunk(nothing.size(), packed);
    for (int i = 0; i < 20; ++i) {
        sut.record(Op::chunk, body);
    }
    std::string const note = note_of(sut.str());
    EXPECT_NE(note.find("it decompresses to more than"), std::string::npos) << note << packed.size();
}

TEST_P(Recording, ItsContentIsKnownWithoutReadingItsData) {
    ASSERT_NO_FATAL_FAILURE(write(1000, true));
    auto sut = content_of(file_);
    ASSERT_TRUE(sut);
    EXPECT_TRUE(sut->indexed && sut->complete);
    EXPECT_EQ(sut->messages, 1000U);
    ASSERT_EQ(sut->channels.size(), 2U);
    EXPECT_EQ(sut->channels[1].channel.metadata.at("process"), "b");
    EXPECT_EQ(sut->channels[1].type, "T");
    EXPECT_EQ(sut->channels[1].messages, 500U);
    EXPECT_EQ(sut->channels[1].first_ns, 1001U);
    EXPECT_EQ(sut->channels[1].last_ns, 1999U);
}

TEST_P(Recording, ItsOctetsAreKnownWithoutReadingItsDataAlsoOfChannelsThatComeLater) {
    auto writer = Writer::create(file_, {.compress = GetParam(), .chunk_octets = 4096});
    ASSERT_TRUE(writer);
    std::uint16_t schema = 0;
    std::vector<std::uint16_t> channels;
    std::vector<std::uint64_t> written;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        if (i % 300 == 0) {
            schema = i % 600 == 0 ? writer->add_schema("T" + std::to_string(i), "omgidl", std::string(i, 'x')) : schema;
            channels.push_back(writer->add_channel(schema, "t" + std::to_string(i), "cdr", {{"process", "p"}}));
            written.push_back(0);
        }
        std::size_t const at = i % 300 == 0 ? channels.size() - 1 : i * 7 % channels.size();
        std::vector<std::byte> const data(i % 97);
        ASSERT_TRUE(writer->write(channels[at], 1, i, data));
        written[at] += data.size();
    }
    ASSERT_TRUE(writer->close());
    auto const sut = content_of(file_);
    ASSERT_TRUE(sut && sut->indexed);
    ASSERT_EQ(sut->channels.size(), written.size());
    for (std::size_t i = 0; i < written.size(); ++i) {
        EXPECT_EQ(sut->channels[i].octets, written[i]) << i;
    }
}

TEST_P(Recording, ItsContentIsReadWhereItHasNoIndex) {
    ASSERT_NO_FATAL_FAILURE(write(1000, false));
    auto sut = content_of(file_);
    ASSERT_TRUE(sut);
    EXPECT_FALSE(sut->indexed || sut->complete);
    EXPECT_EQ(sut->messages, 1000U);
    ASSERT_EQ(sut->channels.size(), 2U);
    EXPECT_EQ(sut->channels[0].last_ns, 1998U);
}

} // namespace
} // namespace gridspace::mcap
