// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Publishers and subscribers over a virtual cable in real time. Counters are judged, times are only reported.
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "veth.hpp"

#include <atomic>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <sched.h>
#include <thread>

namespace gridspace::ethernet {
namespace {

using namespace iec61850;

std::int64_t now() {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

void sleep_until(std::int64_t at) {
    timespec const t{at / 1'000'000'000, at % 1'000'000'000};
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

/// How long the streams run: GRIDSPACE_WIRE_SECONDS (15 in CI, 60 by hand), else 2.
double seconds() {
    char const* const text = std::getenv("GRIDSPACE_WIRE_SECONDS");
    return text != nullptr ? std::atof(text) : 2;
}

Port open(std::string interface, std::uint16_t ethertype, bool receive) {
    PortOptions options{.interface = std::move(interface), .filter = {}, .receive = receive};
    options.filter.ethertypes = {ethertype};
    options.ring_frames = 8'192;
    auto port = Port::open(options);
    EXPECT_TRUE(port) << describe(port.error());
    return std::move(*port);
}

using Streams = Veth;

/// Sends six streams and checks that all of it arrives. False when the machine stood still for so long that frames are
/// those of a publisher that was started again: then nothing is said.
bool six_streams_arrive() {
    constexpr std::size_t kStreams = 6;
    Port receiver = open("right", kSvEthertype, true), sender = open("left", kSvEthertype, false);
    std::vector<SvSubscriber> subscribers;
    std::vector<SvPublisher> publishers;
    for (std::size_t i = 0; i < kStreams; ++i) {
        SvSubscription s;
        s.sv_id = "MU" + std::to_string(i);
        subscribers.emplace_back(s);
        AsduDescription d;
        d.sv_id = s.sv_id;
        d.sample_octets = 12;
        publishers.emplace_back(
            *SvTemplate::create({*Mac::parse("01:0C:CD:04:00:21"), sender.mac(), VlanTag{}, 0x4021, false}, {d}), 4800);
    }
    std::atomic<std::int64_t> sent_frames{-1}, received_frames{0};
    std::thread listening{[&] {
        auto frame = std::make_unique<SvFrame>();
        std::vector<ReceivedFrame> in(256);
        std::int64_t received = 0;
        for (int idle = 0; sent_frames < 0 || (received < sent_frames && idle < 50);) {
            idle = receiver.wait(20'000'000) || sent_frames < 0 ? 0 : idle + 1;
            for (std::size_t n = receiver.receive(in), i = 0; i < n; ++i, received_frames = ++received) {
                ASSERT_TRUE(decode_sv(in[i].octets, *frame));
                for (SvSubscriber& s : subscribers) {
                    if (s.is_mine(frame->asdus[0])) {
                        s.receive(frame->header, frame->asdus[0], in[i].stamp_ns);
                    }
                }
            }
        }
    }};
    std::int64_t const start = now() + 1'000'000, end = start + static_cast<std::int64_t>(seconds() * 1e9);
    SendSchedule schedule{Rational{4800}, 1, start};
    std::vector<Octets> batch(kStreams);
    while (schedule.due_ns() < end) {
        sleep_until(schedule.due_ns());
        for (std::size_t owed = schedule.owed(now(), 64); owed > 0; --owed, schedule.sent(1)) {
            // On a machine that gives the listener no time for a fifth of a second, loss would say nothing about us.
            while (schedule.next_frame() * static_cast<std::int64_t>(kStreams) - received_frames > 6'000) {
                ::sched_yield();
            }
            for (std::size_t i = 0; i < kStreams; ++i) {
                store_float(publishers[i].sample(schedule.next_frame()), 0, 1.0F);
                batch[i] = publishers[i].commit();
            }
            EXPECT_EQ(sender.send(batch), kStreams);
        }
    }
    sent_frames = schedule.next_frame() * static_cast<std::int64_t>(kStreams);
    listening.join();
    constexpr std::int64_t kHalfOfTheCounter = 400'000'000; // with a margin: it runs for a second
    if (schedule.worst_late_ns() > kHalfOfTheCounter) {
        return false;
    }
    for (SvSubscriber const& s : subscribers) {
        auto const& c = s.counters();
        EXPECT_EQ(c.samples, static_cast<std::uint64_t>(schedule.next_frame())) << s.subscription().sv_id;
        EXPECT_EQ(c.lost, 0U);
        EXPECT_EQ(c.of(SvEvent::duplicate) + c.of(SvEvent::late) + c.of(SvEvent::restart), 0U);
    }
    EXPECT_EQ(receiver.counters().dropped, 0U);
    std::printf("rate %.4f Hz, %lu late wake-ups, worst %.0f us\n", subscribers[0].arrivals().rate_hz(),
                schedule.late_wakeups(), static_cast<double>(schedule.worst_late_ns()) / 1e3);
    return true;
}

TEST_F(Streams, SixOf4800HertzArriveCompleteOnceAndInOrder) {
    bool done = false;
    for (int attempt = 0; attempt < 10 && !done; ++attempt) {
        done = six_streams_arrive();
    }
    EXPECT_TRUE(done) << "the machine stood still each time";
}

TEST_F(Streams, ATripArrivesOnceAndIsRepeatedByTheCurve) {
    Port receiver = open("right", kGooseEthertype, true), sender = open("left", kGooseEthertype, false);
    GooseDescription d;
    d.gocb_ref = "IED2LD0/LLN0$GO$Trip";
    d.dat_set = "IED2LD0/LLN0$Trip";
    d.data_set = {{DataNode::leaf("status", BasicType::boolean)}};
    GoosePublisher publisher{
        *GooseTemplate::create({*Mac::parse("01:0C:CD:01:00:02"), sender.mac(), VlanTag{}, 0x8002, false}, d),
        1,
        {.timing = {1'000'000, 10'000'000, 2, 3, 60'000}}}; // a long life: the machine of the test may be busy
    GooseSubscription s;
    s.gocb_ref = d.gocb_ref;
    s.data_set = d.data_set;
    s.app_id = 0x8002;
    GooseSubscriber subscriber{s};
    GooseFrame message;
    std::vector<ReceivedFrame> in(16);
    std::vector<std::uint32_t> sequence;
    publisher.start(now(), 1'575'158'400'000'000'000);
    std::int64_t const start = now();
    bool tripped = false;
    while (subscriber.st_num() < 2 || sequence.size() < 8) {
        ASSERT_LT(now() - start, 30'000'000'000) << "the messages do not arrive";
        if (!tripped && subscriber.st_num() == 1 && now() - start > 50'000'000) {
            tripped = true;
            publisher.set(0, Value::of(true));
            publisher.commit(now(), 1'575'158'400'050'000'000);
        }
        if (Octets const octets = publisher.take(now()); !octets.empty()) {
            ASSERT_TRUE(sender.send(octets));
        }
        receiver.wait(200'000);
        for (std::size_t n = receiver.receive(in), i = 0; i < n; ++i) {
            ASSERT_TRUE(decode_goose(in[i].octets, message));
            auto const verdict = subscriber.receive(message, now());
            EXPECT_TRUE(verdict.accepted) << event_name(verdict.event);
            EXPECT_EQ(subscriber.value(0).boolean(), message.st_num == 2);
            if (message.st_num == 2) {
                sequence.push_back(message.sq_num);
            }
        }
    }
    for (std::uint32_t i = 0; i < sequence.size(); ++i) {
        EXPECT_EQ(sequence[i], i);
    }
    EXPECT_EQ(subscriber.counters().of(GooseEvent::state_change), 1U);
    EXPECT_EQ(subscriber.counters().lost, 0U);
}

} // namespace
} // namespace gridspace::ethernet
