// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/source.hpp"

#include "common/log.hpp"
#include "gateways/iec61850/quality.hpp"
#include "gateways/port/statistics.hpp"
#include "gateways/port/subscriptions.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {

using mapping::BasicType;
using mapping::Value;

void Source::hand_on(Moment at, std::int64_t index) {
    route_.rules.apply(in_, sink_.values());
    sink_.put(at, index);
    if (observer_.mapped) {
        observer_.mapped(at, sink_.values());
    }
}

void Source::set_alive(Moment at, bool alive) {
    if (alive_ != alive) {
        alive_ = alive;
        if (observer_.alive) {
            observer_.alive(at, alive);
        }
    }
}

void Source::lost(Moment at) {
    set_alive(at, false);
    sink_.gap(at);
    if (route_.acts_on_loss) {
        route_.rules.apply(in_, sink_.values());
        route_.on_loss.apply({}, sink_.values());
        sink_.put(at, 0);
        if (observer_.mapped) {
            observer_.mapped(at, sink_.values());
        }
    }
}

void Source::report(StreamStatistics& out) {
    auto const& counters = route_.rules.counters();
    out.saturated(counters.saturated + counters.not_finite);
}

namespace {

class TopicSource final : public Source {
  public:
    TopicSource(Route& route, Sink& sink) : Source{route, sink}, reader_{*route.from_type} {}

    void receive(Moment at, std::span<std::byte const> cdr) override {
        if (!reader_.read(cdr, in_)) {
            if (undecodable_++ == 0) {
                log::warning("a sample of '{}' does not fit its type {}: not mapped (more of them are only counted)",
                             route_.config.from.topic.name, route_.config.from.type.name);
            }
            return;
        }
        for (Route::Filter const& filter : route_.filters) {
            if (!(in_[filter.field] == filter.value)) {
                return;
            }
        }
        last_ns_ = at.ns;
        set_alive(at, true);
        std::int64_t index = route_.index_field ? in_[*route_.index_field].as_signed() : 0;
        if (route_.config.each.empty()) {
            hand_on(at, index);
            return;
        }
        while (reader_.next(in_)) {
            hand_on(at, index++);
        }
    }

    [[nodiscard]] std::optional<std::int64_t> deadline() const override {
        return alive_ && route_.config.lost_after_ms > 0
                   ? std::optional{last_ns_ + static_cast<std::int64_t>(route_.config.lost_after_ms * 1e6)}
                   : std::nullopt;
    }
    void expire(Moment at) override {
        // Texts of the last sample are gone: what was mapped of it stays in the sink.
        set_alive(at, false);
        if (route_.acts_on_loss) {
            route_.on_loss.apply({}, sink_.values());
            sink_.put(at, 0);
            if (observer_.mapped) {
                observer_.mapped(at, sink_.values());
            }
        }
    }
    void report(StreamStatistics& out) override {
        Source::report(out);
        out.refused(out.refused() + undecodable_);
    }

  private:
    mapping::RecordReader reader_;
    std::int64_t last_ns_{0};
    std::uint64_t undecodable_{0};
};

/// The '$' fields that both kinds of stream have.
void fill_common(std::vector<Value>& in, std::size_t first, bool alive, bool simulated) {
    in[first + static_cast<std::size_t>(StreamField::alive)] = Value::of(alive);
    in[first + static_cast<std::size_t>(StreamField::simulated)] = Value::of(simulated);
}

class SvSource final : public Source {
  public:
    SvSource(Route& route, Sink& sink, bool lockstep, double speed, std::vector<streams::Stream> const& declared)
        : Source{route, sink}, subscriber_{subscription_of(route, speed)}, layout_{route.from_stream->data_set},
          first_line_{route.config.first_line, route.from_stream->rate_hz.to_double(), route.config.accept_test,
                      !lockstep} {
        for (streams::Stream const& other : declared) {
            if (&other != route.from_stream && other.kind == streams::Kind::smv && !other.broken &&
                other.sv_id == route.from_stream->sv_id) {
                namesakes_.push_back(other.address);
            }
        }
    }

    void receive(Moment at, iec61850::SvFrame const& frame) override {
        if (is_of_namesake(frame.header)) {
            return;
        }
        auto const asdus = frame.view();
        for (std::size_t place = 0; place < asdus.size(); ++place) {
            if (!subscriber_.is_mine(asdus[place])) {
                continue;
            }
            if (auto const until = deadline(); until && *until < at.arrival_ns()) {
                expire(at); // nobody looked meanwhile
            }
            if (may_use(at, frame.header, asdus[place], place)) {
                take(at, frame.header, asdus[place]);
            }
        }
    }

    [[nodiscard]] std::optional<std::int64_t> deadline() const override { return subscriber_.deadline(); }
    void expire(Moment at) override {
        if (subscriber_.expire(at.ns)) {
            fill_common(in_, route_.stream_fields, false, false);
            lost(at);
        }
    }
    void report(StreamStatistics& out) override {
        Source::report(out);
        report_received(out, subscriber_);
        out.refused(out.refused() + first_line_.refused());
    }
    [[nodiscard]] std::span<std::uint64_t const> findings() const override { return first_line_.counters(); }
    [[nodiscard]] std::uint64_t first_line_refused() const override { return first_line_.refused(); }
    [[nodiscard]] std::uint64_t contested() const override { return first_line_.contested(); }

  private:
    static iec61850::SvSubscription subscription_of(Route const& route, double speed) {
        auto out = sv_subscription(*route.from_stream, speed);
        out.simulation = route.config.accept_test;
        return out;
    }

    /// Of another declared stream with this svID: the address tells them apart.
    [[nodiscard]] bool is_of_namesake(iec61850::FrameHeader const& header) const {
        return !namesakes_.empty() && !subscriber_.is_addressed(header) &&
               std::any_of(namesakes_.begin(), namesakes_.end(), [&](iec61850::Address const& other) {
                   return other.destination == header.destination && other.app_id == header.app_id;
               });
    }

    bool may_use(Moment at, iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, std::size_t place) {
        auto const verdict = first_line_.judge(header, asdu, place, at.arrival_ns());
        if ((verdict.findings & ~kHarmlessSvFindings) != 0 && on_finding_) {
            on_finding_(at, verdict.findings, header.source);
        }
        return verdict.use;
    }

    void take(Moment at, iec61850::FrameHeader const& header, iec61850::Asdu const& asdu) {
        auto const arrival = subscriber_.receive(header, asdu, at.arrival_ns());
        if (!arrival.accepted) {
            return;
        }
        if (arrival.lost > 0 || arrival.event == iec61850::SvEvent::restart) {
            sink_.gap(at);
        }
        set_alive(at, true);
        if (arrival.index % route_.config.every != 0) {
            return;
        }
        for (std::size_t i = 0; i < route_.stream_fields; ++i) {
            in_[i] = layout_.read(i, asdu.sample);
        }
        std::size_t const own = route_.stream_fields;
        fill_common(in_, own, true, header.simulated());
        in_[own + static_cast<std::size_t>(StreamField::smp_cnt)] = {BasicType::uint16, 0, asdu.smp_cnt, {}};
        in_[own + static_cast<std::size_t>(StreamField::index)] = Value::integer(BasicType::int64, arrival.index);
        in_[own + static_cast<std::size_t>(StreamField::smp_synch)] = {BasicType::uint8, 0, asdu.smp_synch, {}};
        hand_on(at, arrival.index);
        for (std::size_t i = 0; i < route_.stream_fields; ++i) {
            in_[i].text = {}; // the frame does not stay
        }
    }

    iec61850::SvSubscriber subscriber_;
    iec61850::SvLayout layout_;
    SvFirstLine first_line_;
    std::vector<iec61850::Address> namesakes_; ///< other streams with the same svID
};

double longest_live_ms(streams::GooseTiming const& timing) {
    return std::max(timing.live_factor * timing.max_time_ms, timing.live_min_ms);
}

class GooseSource final : public Source {
  public:
    GooseSource(Route& route, Sink& sink, WireClock const& clock)
        : Source{route, sink}, clock_{clock}, subscriber_{subscription_of(route)},
          first_line_{route.config.first_line, route.from_stream->timing.min_time_ms,
                      route.from_stream->timing.max_time_ms, route.config.accept_test,
                      longest_live_ms(route.from_stream->timing)} {
        for (std::size_t i = 0; i < route.stream_fields; ++i) {
            quality_ = !route.config.judged_by.empty() && route.from[i].name == route.config.judged_by ? i : quality_;
        }
    }

    void receive(Moment at, iec61850::GooseFrame const& message) override {
        if (message.gocb_ref != route_.from_stream->control_block) {
            return;
        }
        if (auto const until = deadline(); until && *until < at.arrival_ns()) {
            expire(at); // nobody looked meanwhile
        }
        std::int64_t const utc_ns = clock_.utc_at(at.arrival_ns());
        auto const first = first_line_.judge(message, utc_ns);
        if (first.findings != 0) {
            if (on_finding_) {
                on_finding_(at, first.findings, message.header.source);
            }
            if (!first.use) {
                return;
            }
        }
        auto const verdict = subscriber_.receive(message, at.arrival_ns(), utc_ns, first.contested);
        if (verdict.event == iec61850::GooseEvent::not_ours) {
            return;
        }
        if (observer_.heard) {
            observer_.heard(at, message, verdict);
        }
        if (!verdict.accepted) {
            if (refused_++ == 0) {
                log::warning("a message of '{}' was refused: {} (more of them are only counted)",
                             route_.from_stream->name.name, iec61850::event_name(verdict.event));
            }
            return;
        }
        set_alive(at, true);
        fill(true, message.simulated());
        if (is_usable(at)) {
            hand_on(at, 0);
        }
    }

    [[nodiscard]] std::optional<std::int64_t> deadline() const override { return subscriber_.deadline(); }
    void expire(Moment at) override {
        if (subscriber_.expire(at.ns)) {
            first_line_.expired();
            fill(false, false);
            lost(at);
        }
    }
    void report(StreamStatistics& out) override {
        Source::report(out);
        report_received(out, subscriber_);
        out.refused(out.refused() + first_line_.refused());
    }
    [[nodiscard]] std::span<std::uint64_t const> findings() const override { return first_line_.counters(); }
    [[nodiscard]] std::uint64_t first_line_refused() const override { return first_line_.refused(); }

  private:
    static iec61850::GooseSubscription subscription_of(Route const& route) {
        auto out = goose_subscription(*route.from_stream);
        out.simulation = route.config.accept_test;
        return out;
    }

    /// By the quality that judges the values (IEC 61850-7-4, annex A: what is for test is used in test only).
    bool is_usable(Moment at) {
        if (!quality_) {
            return true;
        }
        namespace quality = iec61850::quality;
        auto const q = static_cast<std::uint32_t>(in_[*quality_].bits);
        bool const usable =
            quality::worth(q) == quality::Worth::good && ((q & quality::kTest) == 0 || route_.config.accept_test);
        if (!usable && doubted_ != q && observer_.doubted) {
            observer_.doubted(at, q);
        }
        doubted_ = usable ? 0 : q;
        return usable;
    }

    void fill(bool alive, bool simulated) {
        for (std::size_t i = 0; i < route_.stream_fields; ++i) {
            in_[i] = subscriber_.value(i);
        }
        std::size_t const own = route_.stream_fields;
        fill_common(in_, own, alive, simulated);
        in_[own + static_cast<std::size_t>(StreamField::st_num)] = {BasicType::uint32, 0, subscriber_.st_num(), {}};
        in_[own + static_cast<std::size_t>(StreamField::sq_num)] = {BasicType::uint32, 0, subscriber_.sq_num(), {}};
        in_[own + static_cast<std::size_t>(StreamField::t)] = Value::of(subscriber_.t());
    }

    WireClock const& clock_;
    iec61850::GooseSubscriber subscriber_;
    GooseFirstLine first_line_;
    std::optional<std::size_t> quality_; ///< the leaf that judges the values
    std::uint32_t doubted_{0};           ///< the quality for which they were not used last
    std::uint64_t refused_{0};
};

} // namespace

std::unique_ptr<Source> make_topic_source(Route& route, Sink& sink) {
    return std::make_unique<TopicSource>(route, sink);
}
std::unique_ptr<Source> make_sv_source(Route& route, Sink& sink, bool lockstep, double speed,
                                       std::vector<streams::Stream> const& declared) {
    return std::make_unique<SvSource>(route, sink, lockstep, speed, declared);
}
std::unique_ptr<Source> make_goose_source(Route& route, Sink& sink, WireClock const& clock) {
    return std::make_unique<GooseSource>(route, sink, clock);
}

} // namespace gridspace::gateways
