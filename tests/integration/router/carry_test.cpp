// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The router between domains of a network namespace of the test's own.
#include "bench.hpp"
#include "bus/key_hash.hpp"
#include "tests/integration/veth/veth.hpp"

#include <bus_gateway.h>
#include <set>

namespace gridspace::router {
namespace {

class Carry : public ethernet::Veth {};

constexpr char const* kTwo = "router: r\n"
                             "ends: {a: {domain: 1, addresses: [127.0.0.1]}, b: {domain: 2, addresses: [127.0.0.1]}}\n"
                             "topics: {x: {depth: 2000}}\n"; // nothing is overwritten that a reader is slow to take

/// Writes samples until the reader hears one: everything between them is there. Returns the next number.
std::uint32_t warm_up(bus::RawWriter& writer, Program& reader, std::string const& topic) {
    std::uint32_t number = 0;
    Signal pause;
    EXPECT_TRUE(pause.wait([&] {
        writer.write_cdr(sample(number++), kStart);
        return reader.heard(topic) > 0;
    })) << topic;
    return number;
}

TEST_F(Carry, SamplesArriveInOrderOnceAndWithTheirTime) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter sut{kTwo};
    auto& writer = left.writes("x");
    right.reads("x");
    std::uint32_t const first = warm_up(writer, right, "x");
    for (std::uint32_t i = 0; i < 1000; ++i) {
        ASSERT_TRUE(writer.write_cdr(sample(first + i), kStart + i));
        if (i % 50 == 49) {
            ASSERT_TRUE(
                writer.wait_acknowledged(std::chrono::milliseconds{10'000})); // the history of a writer is bounded
        }
    }
    ASSERT_TRUE(right.wait_heard("x", 1000));
    Signal signal;
    ASSERT_TRUE(signal.wait([&] { return number_of(right.all("x").back().cdr) == first + 999; }));
    auto const all = right.all("x");
    for (std::size_t i = 0; i < 1000; ++i) {
        auto const& one = all[all.size() - 1000 + i];
        ASSERT_EQ(number_of(one.cdr), first + i);
        ASSERT_EQ(one.source_ns, kStart + static_cast<std::int64_t>(i));
        ASSERT_EQ(one.from, "r");
    }
    sut.stop();
    EXPECT_EQ(sut.seen().totals["dropped"], 0U);
    EXPECT_EQ(sut.seen().totals["refused"], 0U);
    EXPECT_GE(sut.seen().totals["x a b"], 1000U);
}

TEST_F(Carry, NothingOutsideTheAllowListPasses) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter sut{kTwo};
    auto &allowed = left.writes("x"), &secret = left.writes("secret");
    right.reads("x");
    right.reads("secret");
    std::uint32_t const first = warm_up(allowed, right, "x");
    for (std::uint32_t i = 0; i < 100; ++i) {
        secret.write_cdr(sample(i), kStart);
        allowed.write_cdr(sample(first + i), kStart);
    }
    ASSERT_TRUE(right.wait_heard("x", 100));
    EXPECT_EQ(right.heard("secret"), 0U);
    EXPECT_EQ(right.sources("secret"), 0U);
    EXPECT_EQ(right.sources("x"), 1U);
}

TEST_F(Carry, BothDirectionsAndNoEchoComesBack) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter sut{kTwo};
    auto &to_right = left.writes("x"), &to_left = right.writes("x");
    left.reads("x");
    right.reads("x");
    warm_up(to_right, right, "x");
    warm_up(to_left, left, "x");
    // A reader does not hear its own program here: what it hears came through the router.
    std::size_t const before_left = left.heard("x"), before_right = right.heard("x");
    for (std::uint32_t i = 0; i < 60; ++i) {
        to_right.write_cdr(sample(10'000 + i), kStart);
        to_left.write_cdr(sample(20'000 + i), kStart);
    }
    ASSERT_TRUE(left.wait_heard("x", before_left + 60));
    ASSERT_TRUE(right.wait_heard("x", before_right + 60));
    for (auto const& one : left.all("x")) {
        EXPECT_FALSE(number_of(one.cdr) >= 10'000 && number_of(one.cdr) < 20'000) << "its own sample came back";
    }
    for (auto const& one : right.all("x")) {
        EXPECT_LT(number_of(one.cdr), 20'000U) << "its own sample came back";
    }
}

TEST_F(Carry, ALoopOfTwoRoutersDoesNotMultiplySamples) {
    Program left{"left", 1}, right{"right", 2}, listener{"listener", 1};
    RunningRouter there{"router: there\nends: {a: {domain: 1, addresses: [127.0.0.1]}, b: {domain: 2, addresses: "
                        "[127.0.0.1]}}\ntopics: {x: {from: [a], to: [b], depth: 2000}}\n"};
    RunningRouter back{"router: back\nends: {a: {domain: 1, addresses: [127.0.0.1]}, b: {domain: 2, addresses: "
                       "[127.0.0.1]}}\ntopics: {x: {depth: 2000}, from_right: {}}\n"};
    auto &writer = left.writes("x"), &from_right = right.writes("from_right");
    right.reads("x");
    listener.reads("x");
    listener.reads("from_right");
    ASSERT_TRUE(right.wait_sources("x", 2));    // both routers carry it
    ASSERT_TRUE(listener.wait_sources("x", 1)); // the writer alone
    std::uint32_t mark = warm_up(writer, right, "x");
    Signal both; // routers hear the writer and are heard: each at its own time
    ASSERT_TRUE(both.wait([&] {
        writer.write_cdr(sample(mark++ % 1000), kStart);
        std::set<std::string> from;
        for (auto const& one : right.all("x")) {
            from.insert(one.from);
        }
        return from.size() == 2;
    }));
    std::uint32_t const marks = warm_up(from_right, listener, "from_right");
    constexpr std::uint32_t kSamples = 200, kFirst = 5000;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        writer.write_cdr(sample(kFirst + i), kStart);
        if (i % 50 == 49) {
            ASSERT_TRUE(writer.wait_acknowledged(std::chrono::milliseconds{10'000})); // its history is bounded
        }
    }
    auto const later = [](Program& program) {
        std::size_t count = 0;
        for (auto const& one : program.all("x")) {
            count += number_of(one.cdr) >= kFirst ? 1U : 0U;
        }
        return count;
    };
    Signal signal;
    ASSERT_TRUE(signal.wait([&] { return later(right) >= 2 * kSamples && later(listener) >= kSamples; }));
    // Whatever went round would come before what is written now, over the same routers.
    from_right.write_cdr(sample(marks + 1'000'000), kStart);
    ASSERT_TRUE(signal.wait([&] { return number_of(listener.all("from_right").back().cdr) == marks + 1'000'000; }));
    EXPECT_EQ(later(right), 2 * kSamples) << "once by each router";
    EXPECT_EQ(later(listener), kSamples) << "from the writer, and never again from a router";
    EXPECT_EQ(listener.sources("x"), 1U);
    std::string const note = "note another router carries 'x' to b";
    EXPECT_TRUE(signal.wait([&] { return there.count(note) + back.count(note) > 0; }));
}

TEST_F(Carry, BestEffortStaysBestEffortAndReliableReliable) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter sut{"router: r\nends: {a: {domain: 1, addresses: [127.0.0.1]}, b: {domain: 2, addresses: "
                      "[127.0.0.1]}}\ntopics: {sure: {}, fast: {}}\n"};
    left.writes("sure", qos(true));
    auto& fast = left.writes("fast", qos(false));
    right.reads("sure", qos(true));
    right.reads("fast", qos(false));
    ASSERT_TRUE(right.wait_sources("sure", 1));
    warm_up(fast, right, "fast");
    ASSERT_TRUE(sut.wait_for("carries sure a reliable")); // said after the readers have been matched
    ASSERT_TRUE(sut.wait_for("carries fast a best effort"));
    EXPECT_EQ(sut.count("carries sure a reliable"), 1U);
    EXPECT_EQ(sut.count("carries fast a best effort"), 1U);
    // A reader that asks for more than the writer offers is not matched, as without the router.
    Program strict{"strict", 2};
    strict.reads("sure", qos(true));
    strict.reads("fast", qos(true));
    ASSERT_TRUE(strict.wait_sources("sure", 1));
    EXPECT_EQ(strict.sources("fast"), 0U);
}

TEST_F(Carry, WhoComesLateGetsTheLastSampleOfEveryInstance) {
    bus::EndpointQos const kept = qos(true, true);
    Program left{"left", 1};
    RunningRouter sut{"router: r\nends: {a: {domain: 1, addresses: [127.0.0.1]}, b: {domain: 2, addresses: "
                      "[127.0.0.1]}}\ntopics: {bus_measurements: {depth: 1}}\n"};
    auto& writer = left.writes("bus_measurements", kept, "BusMeasurement", true);
    ASSERT_TRUE(sut.wait_for("carries bus_measurements"));
    constexpr int kBuses = 40; // more than the ten that DDS allows by itself
    bus::Codec const& codec = bus::codec_of<BusMeasurement>();
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < kBuses; ++i) {
            BusMeasurement m;
            m.bus(("B" + std::to_string(i)).c_str());
            m.v_pu(round);
            std::vector<std::byte> cdr(codec.encoded_size(&m));
            cdr.resize(codec.encode(&m, cdr));
            bus::KeyHash hash{};
            codec.key(&m, hash);
            ASSERT_TRUE(writer.write_cdr(cdr, kStart, &hash));
        }
        ASSERT_TRUE(writer.wait_acknowledged(std::chrono::milliseconds{10'000}));
    }
    Program early{"early", 2};
    early.reads("bus_measurements", kept, "BusMeasurement", true);
    ASSERT_TRUE(early.wait_heard("bus_measurements", kBuses));
    Program late{"late", 2};
    late.reads("bus_measurements", kept, "BusMeasurement", true);
    ASSERT_TRUE(late.wait_heard("bus_measurements", kBuses));
    std::map<std::string, double> last;
    for (auto const& one : late.all("bus_measurements")) {
        BusMeasurement m;
        ASSERT_TRUE(codec.decode(one.cdr, &m));
        last[m.bus().c_str()] = m.v_pu();
    }
    EXPECT_EQ(last.size(), std::size_t{kBuses});
    for (auto const& [bus, v] : last) {
        EXPECT_EQ(v, 2) << bus;
    }
    EXPECT_EQ(late.heard("bus_measurements"), std::size_t{kBuses});
}

TEST_F(Carry, ATopicThatComesBackWithAnotherTypeIsCarriedAgain) {
    Program right{"right", 2};
    RunningRouter sut{kTwo};
    {
        Program old{"old_firmware", 1};
        old.writes("x", qos(true), "OldOctets");
        ASSERT_TRUE(sut.wait_for("carries x a"));
    }
    ASSERT_TRUE(sut.wait_for("stops x a"));
    Program left{"left", 1};
    auto& writer = left.writes("x");
    right.reads("x");
    warm_up(writer, right, "x");
}

TEST_F(Carry, TheIdlOfACarriedTypeGoesAlongAndThatOfOthersDoesNot) {
    Program left{"left", 1}, right{"right", 2};
    RunningRouter sut{kTwo};
    bus::EndpointQos const kept = qos(true, true);
    right.reads("type_catalog", kept, "TypeCatalogEntry", true);
    auto& catalog = left.writes("type_catalog", kept, "TypeCatalogEntry", true);
    auto const entry = [&](char const* type) {
        // TypeCatalogEntry {string type_name; string idl;} by hand
        std::vector<std::byte> cdr{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
        for (std::string const& text : {std::string{type}, "@final struct " + std::string{type} + " { long n; };"}) {
            while (cdr.size() % 4 != 0) {
                cdr.push_back(std::byte{0});
            }
            auto const size = static_cast<std::uint32_t>(text.size() + 1);
            auto const* octets = reinterpret_cast<std::byte const*>(&size);
            cdr.insert(cdr.end(), octets, octets + 4);
            auto const* letters = reinterpret_cast<std::byte const*>(text.c_str());
            cdr.insert(cdr.end(), letters, letters + size);
        }
        return cdr;
    };
    catalog.write_cdr(entry("Hidden"), kStart);
    catalog.write_cdr(entry("Octets"), kStart);
    left.writes("x");
    ASSERT_TRUE(right.wait_heard("type_catalog", 1));
    std::string const text{reinterpret_cast<char const*>(right.all("type_catalog")[0].cdr.data()),
                           right.all("type_catalog")[0].cdr.size()};
    EXPECT_NE(text.find("struct Octets { long n; }"), std::string::npos);
    EXPECT_EQ(right.heard("type_catalog"), 1U);
}

} // namespace
} // namespace gridspace::router
