// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/context.hpp"
#include "gateways/gateway/route.hpp"

#include <memory>
#include <optional>
#include <span>

struct StreamStatistics;

namespace gridspace::gateways {

/// Where the values of a mapping go. Used on the process's own thread.
class Sink {
  public:
    virtual ~Sink() = default;

    /// A value per field of the target. They keep what was written before.
    [[nodiscard]] std::span<mapping::Value> values() noexcept { return values_; }
    /// values() are new. `index`: of the sample, where samples have one.
    virtual void put(Moment at, std::int64_t index) = 0;
    /// Samples are missing before the next one.
    virtual void gap(Moment) {}

    /// The run has begun.
    virtual void start(Moment) {}
    /// When work() is needed next, on the axis of the state machines.
    [[nodiscard]] virtual std::optional<std::int64_t> due() const { return std::nullopt; }
    virtual void work(std::int64_t /*now_ns*/) {}
    virtual void finish(Moment) {}

    /// Its part of the statistics of a stream that it sends.
    virtual void report(StreamStatistics&) {}

  protected:
    /// Zeros of the right types, and the constants of the route.
    explicit Sink(Route& route);
    std::vector<mapping::Value> values_;
};

/// Writes a sample of the topic for every put(), or gathers samples into messages.
[[nodiscard]] std::unique_ptr<Sink> make_topic_sink(GatewayContext const& context, Route& route,
                                                    bus::CdrWriter& writer);

/// Sends a GOOSE stream: a new state when a value changes, repeated as its curve says.
[[nodiscard]] Result<std::unique_ptr<Sink>> make_goose_sink(GatewayContext const& context, Route& route);

} // namespace gridspace::gateways
