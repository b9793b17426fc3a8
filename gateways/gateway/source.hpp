// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/first_line/first_line.hpp"
#include "gateways/gateway/sink.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/mapping/record_reader.hpp"

#include <functional>
#include <memory>
#include <optional>

struct StreamStatistics;

namespace gridspace::gateways {

/// Where the values of a mapping come from: judges what arrives, applies the rules, and hands on to the sink.
class Source {
  public:
    /// What others want to know about a mapping at work: its signals, the log of a breaker.
    struct Observer {
        std::function<void(Moment at, std::span<mapping::Value const>)> mapped; ///< values have been handed to the sink
        std::function<void(Moment at, bool alive)> alive; ///< the source was lost, or is there (again)
        std::function<void(Moment at, iec61850::GooseFrame const&, iec61850::GooseVerdict const&)>
            heard;                                                       ///< every message of the stream
        std::function<void(Moment at, std::uint32_t quality)> doubted{}; ///< values were not used, by their quality
    };
    /// What the first-line rules found in a frame of the stream.
    using OnFinding = std::function<void(Moment at, std::uint32_t findings, iec61850::Mac const& source)>;
    void on_finding(OnFinding on_finding) { on_finding_ = std::move(on_finding); }

    virtual ~Source() = default;
    [[nodiscard]] Route const& route() const { return route_; }
    [[nodiscard]] bool alive() const { return alive_; }
    void observe(Observer observer) { observer_ = std::move(observer); }

    virtual void receive(Moment, std::span<std::byte const> /*cdr*/) {}
    virtual void receive(Moment, iec61850::SvFrame const&) {}
    virtual void receive(Moment, iec61850::GooseFrame const&) {}

    /// When the source counts as lost unless something comes; and: that moment has come.
    [[nodiscard]] virtual std::optional<std::int64_t> deadline() const = 0;
    virtual void expire(Moment at) = 0;

    /// Counters of the first-line rules; none without a stream.
    [[nodiscard]] virtual std::span<std::uint64_t const> findings() const { return {}; }
    [[nodiscard]] virtual std::uint64_t first_line_refused() const { return 0; }
    [[nodiscard]] virtual std::uint64_t contested() const { return 0; }

    /// Its part of the statistics.
    virtual void report(StreamStatistics& out);

  protected:
    Source(Route& route, Sink& sink) : route_{route}, sink_{sink}, in_(route.from.size()) {}
    /// in_ is new: maps it.
    void hand_on(Moment at, std::int64_t index);
    void set_alive(Moment at, bool alive);
    /// The source is lost: the values for that are handed on.
    void lost(Moment at);

    Route& route_;
    Sink& sink_;
    std::vector<mapping::Value> in_; ///< a value per field of the source
    Observer observer_;
    OnFinding on_finding_;
    bool alive_{false};
};

[[nodiscard]] std::unique_ptr<Source> make_topic_source(Route& route, Sink& sink);
/// Constants of the route and their changes; nothing is received.
[[nodiscard]] std::unique_ptr<Source> make_constant_source(Route& route, Sink& sink, WireClock const& clock,
                                                           double speed);
/// `declared`: all streams that are known; one of them may have the same svID at another address. `speed`: of the
/// simulation clock in real time.
[[nodiscard]] std::unique_ptr<Source> make_sv_source(Route& route, Sink& sink, bool lockstep, double speed,
                                                     std::vector<streams::Stream> const& declared);
/// `utc_ns`: for the skew of a message's time.
[[nodiscard]] std::unique_ptr<Source> make_goose_source(Route& route, Sink& sink, WireClock const& clock);

} // namespace gridspace::gateways
