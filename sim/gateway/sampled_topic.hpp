// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "sim/engine/engine.hpp"
#include "sim/gateway/gateway_config.hpp"

#include <memory>
#include <string>

namespace gridspace::sim {

/// A topic of sampled values: the currents of a transformer, or the currents and voltages of a bay.
class SampledTopic {
  public:
    [[nodiscard]] static Result<std::unique_ptr<SampledTopic>> create(bus::Node& node, Engine& engine,
                                                                      LineGatewayConfig::Publish const& publish,
                                                                      std::string const& gateway,
                                                                      SamplingConfig const& sampling);
    virtual ~SampledTopic() = default;

    /// Takes the sample of `t`; a message is sent when it is full.
    virtual void sample(SimTime t, std::uint64_t index) = 0;
    /// What has been gathered is sent.
    virtual void flush() = 0;
    /// Real time, on the publishing thread: writes what was sent up to `until`.
    virtual void drain(SimTime until) = 0;
    [[nodiscard]] virtual std::uint64_t lost() const = 0;
};

} // namespace gridspace::sim
