// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bench/lockstep/exchanges.hpp"

#include "bus/clock_server.hpp"
#include "bus/node.hpp"
#include "bus/participant.hpp"
#include "common/source_tree.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <bench_exchange.h>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <mutex>
#include <netinet/in.h>
#include <poll.h>
#include <set>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace gridspace::bench {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

std::string member_name(int member) {
    return fmt::format("m{:03}", member);
}

template <class T>
T must(Result<T> result) {
    if (!result) {
        fmt::print(stderr, "{}\n", describe(result.error()));
        std::_Exit(1);
    }
    if constexpr (!std::is_void_v<T>) {
        return std::move(*result);
    }
}

std::string qos_file(bool simulator = false) {
    return source_tree(simulator ? "qos/simulator.xml" : "qos/member.xml");
}

bus::NodeConfig node_config(std::string const& name, int members, int domain) {
    bus::NodeConfig config;
    config.process = name;
    config.program = "bench";
    config.qos = qos_file(name == "sim");
    config.management = {domain, {"127.0.0.1"}};
    config.clock.mode = bus::ClockMode::lockstep;
    config.clock.quantum_s = Rational{1, 1000};
    config.clock.tick_s = Rational{1, 1000};
    for (int i = 0; i < members; ++i) {
        config.clock.members.push_back(member_name(i));
    }
    return config;
}

} // namespace

std::vector<double> exchange_contract(int member, int members, std::uint64_t steps, int domain) {
    bus::NodeConfig config = node_config(member < 0 ? "sim" : member_name(member), members, domain);
    if (member >= 0) {
        config.expected_writers["output"]["sim"] = 1;
        config.expected_readers["reply"]["sim"] = 1;
        auto node = must(bus::Node::create(config));
        auto in = must(node->reader<StepOutput>("output"));
        auto out = must(node->writer<StepReply>("reply"));
        must(node->start());
        StepReply reply{};
        while (auto tick = must(node->next())) {
            (void)in->take();
            reply.time_ns(node->time_base().nanoseconds(tick->time));
            out->write(reply, tick->time);
            must(node->done(*tick, tick->number + 1));
        }
        return {};
    }
    std::vector<bus::MemberPlan> plan;
    for (int i = 0; i < members; ++i) {
        config.expected_writers["reply"][member_name(i)] = 1;
        config.expected_readers["output"][member_name(i)] = 1;
        plan.push_back({member_name(i), {}, {}, true});
    }
    auto node = must(bus::Node::create(config));
    auto in = must(node->reader<StepReply>("reply"));
    auto out = must(node->writer<StepOutput>("output"));
    bus::ClockServer clock{*node, plan};
    must(clock.start());
    std::vector<double> times;
    StepOutput output{};
    for (std::uint64_t k = 0; k < steps; ++k) {
        SimTime const now{static_cast<std::int64_t>(k)};
        auto const start = Clock::now();
        output.time_ns(node->time_base().nanoseconds(now));
        out->write(output, now);
        must(clock.tick(now, k + 1 == steps));
        times.push_back(microseconds_since(start));
        if (in->take().size() != static_cast<std::size_t>(members)) {
            fmt::print(stderr, "step {}: wrong number of replies\n", k);
            std::_Exit(1);
        }
    }
    return times;
}

std::vector<double> exchange_bare_dds(int member, int members, std::uint64_t steps, int domain) {
    std::mutex mutex;
    std::condition_variable changed;
    std::uint64_t received = 0;
    std::uint64_t wanted = 0;
    auto participant = must(bus::Participant::create(
        {member < 0 ? "sim" : member_name(member), 0, "bench", domain, qos_file(), "management", {"127.0.0.1"}}));
    auto const on_sample = [&](auto, auto const&) {
        std::lock_guard const lock{mutex};
        if (++received >= wanted) {
            changed.notify_one();
        }
    };
    if (member >= 0) {
        auto out = must(participant->create_writer("reply", bus::codec_of<StepReply>()));
        wanted = 1;
        auto in = must(participant->create_reader("output", bus::codec_of<StepOutput>(), on_sample));
        StepReply const reply{};
        for (std::uint64_t k = 0; k < steps; ++k) {
            {
                std::unique_lock lock{mutex};
                wanted = k + 1;
                changed.wait(lock, [&] { return received >= k + 1; });
            }
            out->write(&reply, std::nullopt);
        }
        out->wait_acknowledged(std::chrono::milliseconds{2000});
        return {};
    }
    auto out = must(participant->create_writer("output", bus::codec_of<StepOutput>()));
    auto in = must(participant->create_reader("reply", bus::codec_of<StepReply>(), on_sample));
    auto const count = static_cast<std::size_t>(members);
    while (out->matched().size() < count || in->matched().size() < count) {
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{300}); // the other side's half of the match
    std::vector<double> times;
    StepOutput const output{};
    for (std::uint64_t k = 0; k < steps; ++k) {
        auto const start = Clock::now();
        {
            std::lock_guard const lock{mutex};
            wanted = (k + 1) * count;
        }
        out->write(&output, std::nullopt);
        std::unique_lock lock{mutex};
        if (!changed.wait_for(lock, std::chrono::seconds{10}, [&] { return received >= wanted; })) {
            fmt::print(stderr, "bare DDS: stalled at step {}\n", k);
            std::_Exit(1);
        }
        times.push_back(microseconds_since(start));
    }
    return times;
}

std::vector<double> exchange_bare_udp(int member, int members, std::uint64_t steps, int domain) {
    auto const address = [&](int who) {
        sockaddr_in a{};
        a.sin_family = AF_INET;
        a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        a.sin_port = htons(static_cast<std::uint16_t>(20000 + domain * 100 + who + 1));
        return a;
    };
    int const fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in const own = address(member);
    if (fd < 0 || ::bind(fd, reinterpret_cast<sockaddr const*>(&own), sizeof own) != 0) {
        std::perror("bare UDP: bind");
        std::_Exit(1);
    }
    timeval const patience{10, 0};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char buffer[1024]{};
    auto const send_to = [&](int who, std::size_t size) {
        sockaddr_in const to = address(who);
        ::sendto(fd, buffer, size, 0, reinterpret_cast<sockaddr const*>(&to), sizeof to);
    };
    std::vector<double> times;
    constexpr std::size_t kOut = 1024, kBack = 32, kHello = 1;
    if (member >= 0) {
        pollfd waiting{fd, POLLIN, 0};
        do {
            send_to(-1, kHello); // until the simulator's socket is bound and it has answered
        } while (::poll(&waiting, 1, 20) == 0);
        for (std::uint64_t k = 0; k < steps && ::recv(fd, buffer, sizeof buffer, 0) > 0; ++k) {
            send_to(-1, kBack);
        }
    } else {
        std::set<std::uint16_t> here;
        while (here.size() < static_cast<std::size_t>(members)) {
            sockaddr_in from{};
            socklen_t length = sizeof from;
            ::recvfrom(fd, buffer, sizeof buffer, 0, reinterpret_cast<sockaddr*>(&from), &length);
            here.insert(from.sin_port);
        }
        for (std::uint64_t k = 0; k < steps; ++k) {
            auto const start = Clock::now();
            for (int i = 0; i < members; ++i) {
                send_to(i, kOut);
            }
            for (int replies = 0; replies < members;) {
                ssize_t const size = ::recv(fd, buffer, sizeof buffer, 0);
                if (size < 0) {
                    std::perror("bare UDP: recv");
                    std::_Exit(1);
                }
                replies += size == static_cast<ssize_t>(kBack) ? 1 : 0; // late hellos do not count
            }
            times.push_back(microseconds_since(start));
        }
    }
    ::close(fd);
    return times;
}

} // namespace gridspace::bench
