// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Nanoseconds per frame of the codec, one thread, frames in the cache.
#include "gateways/iec61850/authentication.hpp"
#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/routable_sender.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <benchmark/benchmark.h>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::iec61850 {
namespace {

Address address() {
    return {*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02:00:00:00:00:01"), VlanTag{}, 0x4021, false};
}

SvTemplate sv(std::size_t asdus, std::size_t octets) {
    AsduDescription d;
    d.sv_id = "GS_TL2_MU21";
    d.sample_octets = octets;
    return *SvTemplate::create(address(), std::vector(asdus, d));
}

GooseTemplate goose(std::size_t elements) {
    GooseDescription d;
    d.gocb_ref = "IED2LD0/LLN0$GO$Trip";
    d.dat_set = "IED2LD0/LLN0$Trip";
    for (std::size_t i = 0; i < elements; ++i) {
        d.data_set.members.push_back(DataNode::leaf("m", i % 2 == 0 ? BasicType::boolean : BasicType::quality));
    }
    return *GooseTemplate::create(address(), d);
}

void encode_sv_three_floats(benchmark::State& state) {
    SvTemplate frame = sv(1, 12);
    std::uint16_t count = 0;
    float value = 1;
    for (auto _ : state) {
        frame.set_smp_cnt(0, count++);
        auto const sample = frame.sample(0);
        store_float(sample, 0, value);
        store_float(sample, 4, value + 1);
        store_float(sample, 8, value + 2);
        value += 0.5F;
        benchmark::DoNotOptimize(frame.frame().data());
        benchmark::ClobberMemory();
    }
}

template <bool kAtOnce>
void encode_sv_92le(benchmark::State& state) {
    SvLayout const layout{data_set_92le()};
    SvTemplate frame = sv(1, layout.sample_octets());
    std::vector<Value> values;
    for (auto const& slot : layout.slots()) {
        values.push_back({slot.leaf.type, 0, 0, {}});
    }
    std::int32_t value = 0;
    for (auto _ : state) {
        frame.set_smp_cnt(0, static_cast<std::uint16_t>(value));
        auto const sample = frame.sample(0);
        for (std::size_t i = 0; i < values.size(); i += 2) {
            values[i].bits = static_cast<std::uint32_t>(value + static_cast<std::int32_t>(i));
        }
        if (kAtOnce) {
            layout.write_all(values, sample);
        } else {
            for (std::size_t i = 0; i < values.size(); ++i) {
                layout.write(i, values[i], sample);
            }
        }
        ++value;
        benchmark::DoNotOptimize(frame.frame().data());
        benchmark::ClobberMemory();
    }
}

void decode_sv_frame(benchmark::State& state, std::size_t asdus, std::size_t octets) {
    SvTemplate const frame = sv(asdus, octets);
    auto const out = std::make_unique<SvFrame>();
    for (auto _ : state) {
        Octets octets_of_frame = frame.frame();
        benchmark::DoNotOptimize(octets_of_frame);
        benchmark::DoNotOptimize(decode_sv(octets_of_frame, *out));
        benchmark::ClobberMemory();
    }
}

void encode_goose(benchmark::State& state) {
    GooseTemplate frame = goose(static_cast<std::size_t>(state.range(0)));
    GooseState s;
    s.live_ms = 30;
    s.st_num = 1000;
    s.sq_num = 1000;
    bool value = false;
    for (auto _ : state) {
        frame.set(0, Value::of(value = !value));
        s.sq_num = s.sq_num == 30'000 ? 1000 : s.sq_num + 1; // no change of length
        benchmark::DoNotOptimize(frame.frame(s).data());
        benchmark::ClobberMemory();
    }
}

void decode_goose_frame(benchmark::State& state) {
    GooseTemplate frame = goose(static_cast<std::size_t>(state.range(0)));
    Octets octets = frame.frame({});
    GooseFrame out;
    for (auto _ : state) {
        benchmark::DoNotOptimize(octets);
        benchmark::DoNotOptimize(decode_goose(octets, out));
        benchmark::ClobberMemory();
    }
}

/// A frame of 9-2LE as a datagram (R-SV): what `udp` in a stream adds for a sender.
void wrap_sv_92le(benchmark::State& state) {
    SvTemplate const frame = sv(1, 64);
    RoutableSender sender{{}};
    std::vector<std::uint8_t> datagram;
    for (auto _ : state) {
        FrameHeader message;
        benchmark::DoNotOptimize(decode_header(frame.frame(), message));
        sender.wrap(message, datagram);
        benchmark::DoNotOptimize(datagram.data());
        benchmark::ClobberMemory();
    }
}

/// The same for a receiver: the message of such a datagram as an Ethernet frame of its own.
void unwrap_sv_92le(benchmark::State& state) {
    SvTemplate const frame = sv(1, 64);
    FrameHeader message;
    std::vector<std::uint8_t> datagram, out;
    if (!decode_header(frame.frame(), message)) {
        state.SkipWithError("the frame is none");
        return;
    }
    RoutableSender{{}}.wrap(message, datagram);
    RoutableFrame opened;
    for (auto _ : state) {
        Octets octets{datagram};
        benchmark::DoNotOptimize(octets);
        if (!decode_routable(routable_payload(octets), opened)) {
            state.SkipWithError("the datagram holds no message");
            break;
        }
        out.clear();
        as_ethernet(octets, opened.payloads[0], out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
}

KeyRing key_ring(CodeAlgorithm algorithm) {
    KeyEntry key;
    key.id = 1;
    key.secret.assign(32, 7);
    return std::move(*KeyRing::create(code_kind(algorithm), {key}));
}

constexpr std::int64_t kNow = 1'700'000'000'000'000'000;

void sign_sv_92le(benchmark::State& state, CodeAlgorithm algorithm) {
    SvTemplate const frame = sv(1, 64);
    KeyRing keys = key_ring(algorithm);
    FrameSigner signer{algorithm};
    std::uint64_t counter = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(signer.sign(frame.frame(), keys, kNow, counter).data());
        benchmark::ClobberMemory();
    }
}

/// With the replay window: the frames of 1024 are judged in their order by a receiver that has not seen them.
void verify_sv_92le(benchmark::State& state, CodeAlgorithm algorithm) {
    SvTemplate const frame = sv(1, 64);
    KeyRing keys = key_ring(algorithm);
    FrameSigner signer{algorithm};
    std::uint64_t counter = 0;
    std::vector<std::vector<std::uint8_t>> frames(1024);
    for (auto& out : frames) {
        Octets const sent = signer.sign(frame.frame(), keys, kNow, counter);
        out.assign(sent.begin(), sent.end());
    }
    FrameVerifier verifier{algorithm, 2'000'000'000};
    std::size_t next = 0;
    for (auto _ : state) {
        if (next == frames.size()) {
            verifier = FrameVerifier{algorithm, 2'000'000'000};
            next = 0;
        }
        if (verifier.judge(frames[next++], keys, kNow) != Authenticity::genuine) {
            state.SkipWithError("a frame was not genuine");
            break;
        }
    }
}

/// A tenth of a second of 64 streams of 4800 Hz, each with keys of its own, in the order in which their frames come:
/// judged, decoded and counted as a subscriber does. All 64 together have 307,200 frames a second.
void authenticated_streams(benchmark::State& state, CodeAlgorithm algorithm) {
    constexpr std::size_t kStreams = 64, kInstants = 480;
    struct Stream {
        SvSubscription subscription;
        SvTemplate frame;
        KeyRing keys;
        FrameVerifier verifier;
        SvSubscriber subscriber;
        std::vector<std::vector<std::uint8_t>> frames;
    };
    std::vector<Stream> streams;
    for (std::size_t s = 0; s < kStreams; ++s) {
        AsduDescription d;
        d.sv_id = "MU" + std::to_string(s);
        d.sample_octets = 64;
        Address from = address();
        from.app_id = static_cast<std::uint16_t>(0x4000 + s);
        from.source.octets[5] = static_cast<std::uint8_t>(s);
        KeyEntry key;
        key.id = static_cast<std::uint32_t>(s + 1);
        key.secret.assign(32, static_cast<std::uint8_t>(s));
        SvSubscription subscription;
        subscription.sv_id = d.sv_id;
        streams.push_back({subscription,
                           *SvTemplate::create(from, {d}),
                           std::move(*KeyRing::create(code_kind(algorithm), {key})),
                           FrameVerifier{algorithm, 2'000'000'000},
                           SvSubscriber{subscription},
                           {}});
        FrameSigner signer{algorithm};
        std::uint64_t counter = 0;
        for (std::size_t n = 0; n < kInstants; ++n) {
            streams.back().frame.set_smp_cnt(0, static_cast<std::uint16_t>(n));
            Octets const sent = signer.sign(streams.back().frame.frame(), streams.back().keys, kNow, counter);
            streams.back().frames.emplace_back(sent.begin(), sent.end());
        }
    }
    auto const decoded = std::make_unique<SvFrame>();
    std::size_t next = 0;
    std::int64_t now_ns = 0;
    for (auto _ : state) {
        Stream& stream = streams[next % kStreams];
        std::size_t const instant = next / kStreams;
        if (instant == 0) { // the same frames again are for a receiver that has not seen them
            stream.verifier = FrameVerifier{algorithm, 2'000'000'000};
            stream.subscriber = SvSubscriber{stream.subscription};
        }
        Octets const frame = stream.frames[instant];
        now_ns += next % kStreams == 0 ? 208'333 : 0;
        if (stream.verifier.judge(frame, stream.keys, kNow) != Authenticity::genuine || !decode_sv(frame, *decoded) ||
            !stream.subscriber.receive(decoded->header, decoded->asdus[0], now_ns).accepted) {
            state.SkipWithError("a frame was not taken");
            break;
        }
        next = next + 1 == kStreams * kInstants ? 0 : next + 1;
    }
}

BENCHMARK(encode_sv_three_floats);
BENCHMARK(encode_sv_92le<true>)->Name("encode_sv_92le/at_once");
BENCHMARK(encode_sv_92le<false>)->Name("encode_sv_92le/value_by_value");
BENCHMARK_CAPTURE(decode_sv_frame, three_floats, 1, 12);
BENCHMARK_CAPTURE(decode_sv_frame, le92, 1, 64);
BENCHMARK_CAPTURE(decode_sv_frame, two_asdus, 2, 12);
BENCHMARK_CAPTURE(sign_sv_92le, hmac_sha256, CodeAlgorithm::hmac_sha256_128);
BENCHMARK_CAPTURE(sign_sv_92le, aes_gmac, CodeAlgorithm::aes_gmac_128);
BENCHMARK_CAPTURE(verify_sv_92le, hmac_sha256, CodeAlgorithm::hmac_sha256_128);
BENCHMARK_CAPTURE(verify_sv_92le, aes_gmac, CodeAlgorithm::aes_gmac_128);
BENCHMARK_CAPTURE(authenticated_streams, hmac_sha256, CodeAlgorithm::hmac_sha256_128);
BENCHMARK_CAPTURE(authenticated_streams, aes_gmac, CodeAlgorithm::aes_gmac_128);
BENCHMARK(wrap_sv_92le);
BENCHMARK(unwrap_sv_92le);
BENCHMARK(encode_goose)->Arg(1)->Arg(16);
BENCHMARK(decode_goose_frame)->Arg(1)->Arg(16);

} // namespace
} // namespace gridspace::iec61850

BENCHMARK_MAIN();
