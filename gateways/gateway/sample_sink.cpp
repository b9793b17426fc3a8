// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/sample_sink.hpp"

#include <algorithm>
#include <cmath>
#include <statistics.h>

namespace gridspace::gateways {
namespace {

constexpr unsigned kClockAccuracyBits = 0x0A; ///< of the times that are stamped: about a millisecond

} // namespace

SampleSink::SampleSink(GatewayContext const& context, Route& route, iec61850::SvTemplate frame)
    : Sink{route}, context_{context}, route_{route}, layout_{route.to_stream->data_set},
      publisher_{std::move(frame), static_cast<std::uint32_t>(route.to_stream->rate_hz.num())},
      period_quanta_{Rational{1} / route.to_stream->rate_hz / context.node.time_base().quantum_s()},
      grid_{route.to_stream->rate_hz}, synch_{route.to_stream->smp_synch} {}

void SampleSink::encode(std::span<std::uint8_t> sample) const {
    layout_.write_all(values_, sample); // what no rule writes is zero
}

iec61850::Octets SampleSink::fill(std::int64_t index, std::span<std::uint8_t const> sample) {
    obey_clock_changes(index);
    follow_clock();
    std::copy(sample.begin(), sample.end(), publisher_.sample(index).begin());
    if (shift_samples_ != 0) {
        std::int64_t const wrap = route_.to_stream->rate_hz.num();
        std::int64_t const count = ((index + shift_samples_) % wrap + wrap) % wrap;
        publisher_.frame().set_smp_cnt(static_cast<std::size_t>(index) % publisher_.samples_per_frame(),
                                       static_cast<std::uint16_t>(count));
    }
    if (stream().send_refr_tm) {
        // By the clock of the device: with one that runs ahead, its counter and its time do.
        bool const synchronised = synch_ != iec61850::kNotSynchronised;
        auto const quality = static_cast<std::uint8_t>(
            kClockAccuracyBits | (synchronised ? 0U : unsigned{iec61850::UtcTime::kNotSynchronised}));
        publisher_.frame().set_refr_tm(
            static_cast<std::size_t>(index) % publisher_.samples_per_frame(),
            iec61850::UtcTime::from_nanoseconds(
                std::max<std::int64_t>(0, taken_unix_ns(index) + grid_.nanoseconds(shift_samples_)), quality));
    }
    auto const frame = publisher_.commit();
    incomplete_.store(publisher_.incomplete(), std::memory_order_relaxed);
    return frame;
}

std::int64_t SampleSink::taken_unix_ns(std::int64_t index) {
    std::int64_t const ns = grid_.nanoseconds(index);
    if (context_.node.lockstep()) {
        return context_.clock.utc_ns(ns);
    }
    if (!zero_unix_ns_) {
        zero_unix_ns_ = context_.clock.known_start_unix_ns();
    }
    if (!zero_unix_ns_) { // it has just come
        return context_.clock.utc_ns(0);
    }
    double const speed = context_.wire.speed;
    return *zero_unix_ns_ + (speed == 1 ? ns : std::llround(static_cast<double>(ns) / speed));
}

/// Without a simulator nobody knows when the index of a foreign sample was 0: then it was taken when it came here.
std::int64_t IndexedSink::taken_unix_ns(std::int64_t index) {
    bool const foreign = !context_.node.lockstep() && context_.node.config().clock.simulator.empty();
    return foreign ? context_.clock.utc_ns(0) : SampleSink::taken_unix_ns(index);
}

void SampleSink::obey_clock_changes(std::int64_t index) {
    auto const& changes = route_.config.clock_changes;
    for (; next_clock_change_ < changes.size(); ++next_clock_change_) {
        ClockChange const& change = changes[next_clock_change_];
        if (Rational{index} < change.at_s * route_.to_stream->rate_hz) {
            return;
        }
        clock_is_lost_ = !change.synchronised;
        shift_samples_ = change.synchronised ? 0 : change.shift_samples;
    }
}

void SampleSink::follow_clock() {
    std::uint8_t const synch = clock_is_lost_                 ? iec61850::kNotSynchronised
                               : context_.follower != nullptr ? context_.follower->smp_synch()
                                                              : route_.to_stream->smp_synch;
    if (synch != synch_) {
        synch_ = synch;
        publisher_.set_synch(synch);
    }
}

void SampleSink::departs(std::int64_t index) {
    if (!context_.node.lockstep()) {
        departures_.push({index, context_.clock.utc_ns(0)});
    }
    sent_.fetch_add(1, std::memory_order_relaxed);
}

SimTime SampleSink::instant(std::int64_t index) const {
    __extension__ using Wide = __int128;
    Wide const num = Wide{index} * period_quanta_.num();
    Wide const den = period_quanta_.den();
    return {static_cast<std::int64_t>((num + den - 1) / den)};
}

bool SampleSink::is_over(std::int64_t index) const {
    bus::Node const& node = context_.node;
    return instant(index) <= node.latest_time() - node.time_base().nearest(node.config().clock.tick_s);
}

void SampleSink::report(StreamStatistics& out) {
    out.state(sent() > 0 ? STREAM_ALIVE : STREAM_WAITING);
    out.frames(sent());
    out.lost(incomplete_.load(std::memory_order_relaxed));
    out.late(late());
    out.underruns(underruns());
}

Result<std::unique_ptr<IndexedSink>> IndexedSink::create(GatewayContext const& context, Route& route) {
    auto frame = route.to_stream->sv_template(context.port.mac());
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    auto out = std::unique_ptr<IndexedSink>{new IndexedSink{context, route, std::move(*frame)}};
    IndexedSink* const raw = out.get();
    raw->sample_.resize(raw->layout_.sample_octets());
    raw->encode(raw->sample_); // constants
    if (context.node.lockstep() || route.config.sending == MappingConfig::Sending::on_arrival) {
        return out;
    }
    auto own = FrameSender::open(context.wire, context.port.sequence(), context.port.authentication());
    if (!own) {
        return std::unexpected{own.error()};
    }
    raw->frames_ = std::make_unique<FrameSender>(std::move(*own));
    ScheduledSender::Params params;
    params.rate_hz = raw->stream().rate_hz.to_double() * context.wire.speed;
    params.buffer_s = route.config.buffer_ms / 1e3;
    params.sample_octets = raw->sample_.size();
    params.expects_zero = !context.node.config().clock.simulator.empty();
    raw->sender_ = std::make_unique<ScheduledSender>(
        params,
        [raw](std::int64_t index, std::span<std::uint8_t const> sample) {
            if (auto const full = raw->fill(index, sample); !full.empty()) {
                raw->departs(index);
                raw->frames_->send(full);
            }
        },
        [raw] { raw->frames_->maintain(); });
    return out;
}

void IndexedSink::put(Moment, std::int64_t index) {
    if (index < 0) {
        ++missed_; // no sample is before the first
        return;
    }
    encode(sample_);
    if (sender_ != nullptr) {
        bool const has_clock = !context_.node.config().clock.simulator.empty();
        std::int64_t const zero = zero_is_known_ || !has_clock ? 0 : context_.node.start_unix_ns();
        if (zero != 0) {
            zero_is_known_ = true; // once: from then on it is a device with a clock of its own
            ArrivalClock::Reading const now = ArrivalClock::read();
            sender_->set_zero(zero - now.utc_ns + now.steady_ns);
        }
        sender_->push(index, sample_);
        return;
    }
    if (context_.node.lockstep() && is_over(index)) {
        ++missed_;
        return;
    }
    if (auto const frame = fill(index, sample_); !frame.empty()) {
        departs(index);
        context_.port.send(frame, instant(index) + context_.latency);
    }
}

ZeroOrderHoldSink::ZeroOrderHoldSink(GatewayContext const& context, Route& route, iec61850::SvTemplate frame)
    : SampleSink{context, route, std::move(frame)}, current_(layout_.sample_octets()),
      newest_{std::vector<std::uint8_t>(layout_.sample_octets())} {}

Result<std::unique_ptr<ZeroOrderHoldSink>> ZeroOrderHoldSink::create(GatewayContext const& context, Route& route) {
    auto frame = route.to_stream->sv_template(context.port.mac());
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    return std::unique_ptr<ZeroOrderHoldSink>{new ZeroOrderHoldSink{context, route, std::move(*frame)}};
}

void ZeroOrderHoldSink::start(Moment at) {
    if (route_.config.start == MappingConfig::Start::at_once) {
        begin(at);
    }
}

void ZeroOrderHoldSink::begin(Moment at) {
    encode(current_);
    if (!context_.node.lockstep()) {
        newest_.back() = current_;
        newest_.publish();
        has_values_.store(true, std::memory_order_release);
        return;
    }
    if (!next_) { // the first sample that begins a frame and is not before now
        auto const frame_quanta = period_quanta_ * Rational{samples_per_frame()};
        Rational const frames = Rational{std::max<std::int64_t>(at.time.quanta, 0)} / frame_quanta;
        next_ = (frames.num() + frames.den() - 1) / frames.den() * samples_per_frame();
    }
}

void ZeroOrderHoldSink::put(Moment at, std::int64_t) {
    begin(at);
}

std::optional<std::int64_t> ZeroOrderHoldSink::due() const {
    return next_ ? std::optional{context_.clock.of(instant(*next_))} : std::nullopt;
}

/// It goes on with the first whole frame of the present tick.
void ZeroOrderHoldSink::skip_what_is_over() {
    if (!next_ || !is_over(*next_)) {
        return;
    }
    std::int64_t const before = *next_;
    while (is_over(*next_) || *next_ % samples_per_frame() != 0) {
        ++*next_;
    }
    missed_ += static_cast<std::uint64_t>(*next_ - before);
}

void ZeroOrderHoldSink::work(std::int64_t now_ns) {
    skip_what_is_over();
    while (next_ && context_.clock.of(instant(*next_)) <= now_ns) {
        if (auto const frame = fill(*next_, current_); !frame.empty()) {
            departs(*next_);
            context_.port.send(frame, instant(*next_) + context_.latency);
        }
        ++*next_;
    }
}

iec61850::Octets ZeroOrderHoldSink::sample_now(std::int64_t index) {
    auto const frame = fill(index, newest_.front());
    if (!frame.empty()) {
        departs(index);
    }
    return frame;
}

} // namespace gridspace::gateways
