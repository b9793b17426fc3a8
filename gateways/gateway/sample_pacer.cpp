// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/sample_pacer.hpp"

#include "common/sleep_until.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace gridspace::gateways {
namespace {

constexpr std::size_t kOwedAtOnce = 16; ///< samples of a stream in one wake-up; a longer stall takes several

std::int64_t now_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

} // namespace

SamplePacer::SamplePacer(WireConfig const& wire, std::vector<ZeroOrderHoldSink*> streams, FrameSender sender)
    : sender_{std::move(sender)} {
    Rational const speed = Rational::parse(shortest(wire.speed)).value_or(Rational{1});
    for (ZeroOrderHoldSink* sink : streams) {
        streams_.push_back({sink, sink->stream().rate_hz * speed, std::nullopt});
    }
}

Result<std::unique_ptr<SamplePacer>> SamplePacer::create(WireConfig const& wire, WirePort& port,
                                                         std::vector<ZeroOrderHoldSink*> streams) {
    auto sender = FrameSender::open(wire, port.sequence(), port.authentication());
    if (!sender) {
        return std::unexpected{sender.error()};
    }
    return std::unique_ptr<SamplePacer>{new SamplePacer{wire, std::move(streams), std::move(*sender)}};
}

SamplePacer::~SamplePacer() {
    stop_ = true;
    if (thread_.joinable()) {
        thread_.join();
    }
}

void SamplePacer::start(std::int64_t zero_unix_ns) {
    if (thread_.joinable()) {
        return;
    }
    // Once: from then on this is a device with a clock of its own, and a step of the wall clock does not disturb it.
    zero_ns_ = zero_unix_ns - now_ns(CLOCK_REALTIME) + now_ns(CLOCK_MONOTONIC);
    thread_ = std::thread{[this] { loop(); }};
}

/// Gives a schedule to every stream that has got its first values; the earliest deadline of all.
std::int64_t SamplePacer::begin_due(std::int64_t now) {
    constexpr std::int64_t kLookNs = 1'000'000;
    std::int64_t due = now + kLookNs;
    for (Paced& stream : streams_) {
        if (!stream.schedule && stream.sink->has_values()) {
            double const frames = static_cast<double>(now - zero_ns_) * 1e-9 * stream.rate_hz.to_double() /
                                  static_cast<double>(stream.sink->samples_per_frame());
            auto const first = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(frames))) *
                               stream.sink->samples_per_frame();
            stream.schedule.emplace(stream.rate_hz, 1, zero_ns_, first);
        }
        if (stream.schedule) {
            due = std::min(due, stream.schedule->due_ns());
        }
    }
    return due;
}

void SamplePacer::loop() {
    constexpr std::int64_t kLookAfterNs = 200'000'000;
    std::vector<iec61850::Octets> frames(streams_.size());
    std::vector<std::size_t> owed(streams_.size());
    std::int64_t looked = 0;
    while (!stop_) {
        sleep_until(begin_due(now_ns(CLOCK_MONOTONIC)));
        std::int64_t const now = now_ns(CLOCK_MONOTONIC);
        std::size_t rounds = 0;
        for (std::size_t i = 0; i < streams_.size(); ++i) {
            owed[i] = streams_[i].schedule ? streams_[i].schedule->owed(now, kOwedAtOnce) : 0;
            rounds = std::max(rounds, owed[i]);
        }
        for (std::size_t round = 0; round < rounds; ++round) {
            std::size_t count = 0;
            for (std::size_t i = 0; i < streams_.size(); ++i) {
                if (round < owed[i]) {
                    frames[count] = streams_[i].sink->sample_now(streams_[i].schedule->next_frame());
                    streams_[i].schedule->sent(1);
                    count += frames[count].empty() ? 0 : 1;
                }
            }
            sender_.send(std::span{frames}.first(count));
        }
        for (Paced& stream : streams_) {
            if (stream.schedule) {
                stream.sink->count_late(stream.schedule->late_wakeups());
            }
        }
        if (now - looked > kLookAfterNs) {
            looked = now;
            sender_.maintain();
        }
    }
}

} // namespace gridspace::gateways
