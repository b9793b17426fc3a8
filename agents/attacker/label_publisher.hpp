// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/sample_attack.hpp"
#include "bus/node.hpp"

#include <intrusion.h>

#include <memory>
#include <string>

namespace gridspace::attacker {

/// Publishes the labels of one attack, a hundredth of a second in a message; where a message ends depends on the labels
/// alone.
class LabelPublisher {
  public:
    LabelPublisher(bus::Writer<AttackLabel>& writer, std::string const& attack, std::string const& kind,
                   std::string const& target)
        : writer_{&writer}, message_{std::make_unique<AttackLabel>()} {
        message_->attack(attack.c_str());
        message_->kind(kind.c_str());
        message_->target(target.c_str());
        message_->values().reserve(MAX_LABELS_PER_MESSAGE);
    }

    /// `time_ns`: simulated, when the value was sent; `now`: not before it.
    void add(Label const& label, std::int64_t time_ns, SimTime now) {
        constexpr std::int64_t kBlockNs = 10'000'000;
        auto& values = message_->values();
        if (values.size() >= MAX_LABELS_PER_MESSAGE ||
            (!values.empty() && time_ns / kBlockNs != message_->time_ns() / kBlockNs)) {
            flush(now);
        }
        LabelledValue value;
        value.index(static_cast<std::uint64_t>(label.index < 0 ? 0 : label.index));
        value.channel(label.channel);
        value.true_value(label.true_a);
        value.sent_value(label.sent_a);
        values.push_back(value);
        message_->time_ns(time_ns);
    }
    void flush(SimTime now) {
        if (!message_->values().empty()) {
            writer_->write(*message_, now);
            message_->values().clear();
        }
    }

  private:
    bus::Writer<AttackLabel>* writer_;
    std::unique_ptr<AttackLabel> message_;
};

} // namespace gridspace::attacker
