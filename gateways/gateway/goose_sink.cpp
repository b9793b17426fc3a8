// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/sink.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/port/statistics.hpp"
#include "gateways/port/subscriptions.hpp"

#include <deque>

namespace gridspace::gateways {
namespace {

using mapping::Value;

class GooseSink final : public Sink {
  public:
    GooseSink(GatewayContext const& context, Route& route, iec61850::GooseTemplate frame)
        : Sink{route}, context_{context}, route_{route},
          publisher_{std::move(frame), route.to_stream->conf_rev, goose_publisher_params(*route.to_stream)} {}

    void start(Moment at) override {
        if (route_.config.start == MappingConfig::Start::at_once) {
            stage(values_);
            publisher_.start(at.ns, context_.clock.utc_ns(at.ns));
            work(at.ns);
        }
    }

    void put(Moment at, std::int64_t) override {
        if (!context_.node.lockstep()) {
            stage(values_);
            begin(at.ns);
            work(at.ns);
            return;
        }
        State state{at.ns + context_.latency_ns(), {}, {}};
        for (std::size_t const field : route_.written) {
            auto const text = values_[field].text;
            state.texts.emplace_back(text.begin(), text.end());
            state.values.push_back(values_[field]);
            state.values.back().text = state.texts.back();
        }
        waiting_.push_back(std::move(state));
    }

    [[nodiscard]] std::optional<std::int64_t> due() const override {
        auto due = publisher_.due();
        if (!waiting_.empty()) {
            due = due ? std::min(*due, waiting_.front().at_ns) : waiting_.front().at_ns;
        }
        return due;
    }

    void work(std::int64_t now_ns) override {
        if (!waiting_.empty() && waiting_.front().at_ns <= now_ns) {
            State const& state = waiting_.front();
            for (std::size_t i = 0; i < route_.written.size(); ++i) {
                publisher_.set(route_.written[i], state.values[i]);
            }
            begin(now_ns);
            waiting_.pop_front();
        }
        send(publisher_.take(now_ns), now_ns);
    }

    /// In real time the last word goes out once more. In lockstep the run ends at an instant, for everybody.
    void finish(Moment at) override {
        if (!context_.node.lockstep()) {
            send(publisher_.last(at.ns), at.ns);
        }
    }

    void report(StreamStatistics& out) override { report_sent(out, publisher_.counters()); }

  private:
    struct State {
        std::int64_t at_ns;
        std::vector<Value> values; ///< of the written fields
        std::vector<std::vector<std::uint8_t>> texts;
    };

    void stage(std::span<Value const> values) {
        for (std::size_t const field : route_.written) {
            publisher_.set(field, values[field]);
        }
    }
    void begin(std::int64_t now_ns) {
        if (publisher_.due()) {
            publisher_.commit(now_ns, context_.clock.utc_ns(now_ns));
        } else {
            publisher_.start(now_ns, context_.clock.utc_ns(now_ns));
        }
    }
    void send(iec61850::Octets frame, std::int64_t now_ns) {
        if (!frame.empty()) {
            context_.port.send(frame, context_.node.lockstep() ? context_.clock.at_or_after(now_ns)
                                                               : context_.node.latest_time());
        }
    }

    GatewayContext const& context_;
    Route& route_;
    iec61850::GoosePublisher publisher_;
    std::deque<State> waiting_; ///< lockstep: until the latency is over
};

} // namespace

Result<std::unique_ptr<Sink>> make_goose_sink(GatewayContext const& context, Route& route) {
    auto frame = route.to_stream->goose_template(context.port.mac());
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    return std::make_unique<GooseSink>(context, route, std::move(*frame));
}

} // namespace gridspace::gateways
