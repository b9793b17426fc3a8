// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A crowd in a DDS domain, to load a monitor: participants that each write some topics and read those of the next
// one. Samples are octets of a type that nobody was compiled for. Usage: bench_crowd QOS_FILE DOMAIN PARTICIPANTS
// TOPICS_EACH SAMPLES_PER_SECOND Prints "there" when all have been made; ends when its standard input does.
#include "bus/participant.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace gridspace;

struct Crowd {
    std::vector<std::unique_ptr<bus::Participant>> participants;
    std::vector<std::unique_ptr<bus::RawWriter>> writers;
    std::vector<std::unique_ptr<bus::RawReader>> readers;
};

/// What cannot be made is printed.
std::optional<Crowd> make_crowd(char const* qos_file, int domain, int participants, int topics,
                                std::atomic<std::uint64_t>& received) {
    bus::Codec codec;
    codec.type_name = "CrowdSample";
    Crowd crowd;
    auto const topic = [&](int participant, int i) {
        return fmt::format("crowd_{:03}_{}", participant % participants, i);
    };
    for (int p = 0; p < participants; ++p) {
        bus::ParticipantOptions options;
        options.process = fmt::format("crowd{:03}", p);
        options.program = "bench_crowd";
        options.domain = domain;
        options.qos_file = qos_file;
        options.addresses = {"127.0.0.1"};
        auto made = bus::Participant::create(std::move(options));
        if (!made) {
            std::fprintf(stderr, "participant %d: %s\n", p, describe(made.error()).c_str());
            return std::nullopt;
        }
        for (int i = 0; i < topics; ++i) {
            auto writer = (*made)->create_writer(topic(p, i), codec);
            auto reader = (*made)->create_reader(
                topic(p + 1, i), codec,
                [&received](std::span<std::byte const>, bus::SampleHeader const&) { ++received; });
            if (!writer || !reader) {
                std::fprintf(stderr, "participant %d: no endpoint\n", p);
                return std::nullopt;
            }
            crowd.writers.push_back(std::move(*writer));
            crowd.readers.push_back(std::move(*reader));
        }
        crowd.participants.push_back(std::move(*made));
    }
    return crowd;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 6) {
        std::fprintf(stderr, "usage: bench_crowd QOS_FILE DOMAIN PARTICIPANTS TOPICS_EACH SAMPLES_PER_SECOND\n");
        return 2;
    }
    int const domain = std::atoi(argv[2]), participants = std::atoi(argv[3]), topics = std::atoi(argv[4]);
    double const rate = std::atof(argv[5]); // of all topics together
    std::atomic<std::uint64_t> received{0};
    auto const crowd = make_crowd(argv[1], domain, participants, topics, received);
    if (!crowd) {
        return 3;
    }
    std::printf("there\n");
    std::fflush(stdout);
    std::atomic<bool> ending{false};
    std::thread const input{[&] {
        char c = 0;
        while (::read(0, &c, 1) > 0) {
        }
        ending = true;
    }};
    std::array<std::byte, 68> sample{std::byte{0}, std::byte{1}};
    auto next = std::chrono::steady_clock::now();
    for (std::size_t i = 0; !ending; i = (i + 1) % crowd->writers.size()) {
        (void)crowd->writers[i]->write_cdr(sample, std::nullopt);
        next += std::chrono::nanoseconds{static_cast<std::int64_t>(1e9 / rate)};
        std::this_thread::sleep_until(next);
    }
    std::printf("%llu samples received\n", static_cast<unsigned long long>(received.load()));
    std::fflush(stdout);
    std::_Exit(0); // a hundred participants take long to say goodbye
}
