// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/inbox.hpp"
#include "sdk/sample_block.hpp"
#include "sdk/sample_filter.hpp"
#include "sdk/topic_type.hpp"

namespace gridspace::sdk {

/// The reading end of a topic whose type is known when the program runs.
class SampleInbox final : public bus::Inbox {
  public:
    SampleInbox(std::shared_ptr<TopicType const> type, SampleFilter filter)
        : type_{std::move(type)}, filter_{std::move(filter)} {}

    /// A sample that is due, and which reader it came to.
    struct Arrival {
        bus::Origin origin;
        int reader;
        KeptSample sample;
    };
    /// Moves what is due now behind `arrivals`, in no order.
    void take(int reader, std::vector<Arrival>& arrivals);

    bool push(std::span<std::byte const> cdr, bus::Origin origin, TimeBase const& base) override;
    [[nodiscard]] bool has_due(SimTime until) const override;

  private:
    std::shared_ptr<TopicType const> type_;
    SampleFilter filter_;
    std::vector<Arrival> waiting_;
};

} // namespace gridspace::sdk
