// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/frame_forger.hpp"

#include "agents/attacker/sv_forger.hpp"
#include "gateways/iec61850/ber.hpp"
#include "gateways/iec61850/sample_index.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

using Kind = FrameAttackParams::Kind;
constexpr std::uint8_t kSmpCnt = 0x82, kSmpSynch = 0x85; ///< IEC 61850-9-2, table 14
constexpr std::uint8_t kWholeFrame = 3;                  ///< channel of a label
constexpr std::size_t kSourceAt = 6;

} // namespace

Result<std::unique_ptr<FrameForger>> FrameForger::create(streams::Stream const& stream, AttackConfig const& config,
                                                         std::uint64_t seed) {
    auto const bad = [&](std::string what) {
        return fail(ExitCode::usage, fmt::format("attack '{}': {}", config.name.name, what));
    };
    std::int64_t const wrap = std::llround(stream.rate_hz.to_double());
    if (config.frames->kind == Kind::counter_jump &&
        (config.frames->jump == 0 || std::abs(config.frames->jump) >= wrap)) {
        return bad(fmt::format("a jump by {} samples; the counter of '{}' runs from 0 to {}", config.frames->jump,
                               stream.name.name, wrap - 1));
    }
    auto out = std::unique_ptr<FrameForger>{new FrameForger{stream, config, seed}};
    if (config.when && !config.waits_for_other()) {
        auto condition = StreamCondition::create(stream, config.name.name, *config.when, config.channels);
        if (!condition) {
            return std::unexpected{condition.error()};
        }
        out->condition_ = std::move(*condition);
    }
    return out;
}

FrameForger::FrameForger(streams::Stream const& stream, AttackConfig const& config, std::uint64_t seed)
    : target_{stream}, rate_hz_{stream.rate_hz.to_double()}, attack_{*config.frames, times_in_ns(config), seed},
      in_cable_{config.place == AttackConfig::Place::between}, spoof_{config.spoof} {
    buffer_.reserve(2048);
    newest_.reserve(iec61850::kMaxAsdus);
}

bool FrameForger::rewrite(iec61850::Asdu const& asdu, std::uint8_t tag, std::size_t octets, std::uint64_t value) {
    iec61850::Tlv element;
    iec61850::BerCursor outer{iec61850::Octets{buffer_}.subspan(asdu.offset), asdu.offset};
    if (outer.next(element) != iec61850::Reason::none) {
        return false;
    }
    iec61850::BerCursor inner{element};
    while (!inner.at_end() && inner.next(element) == iec61850::Reason::none) {
        if (element.tag == tag && element.value.size() == octets) {
            for (std::size_t i = 0; i < octets; ++i) {
                buffer_[element.value_offset + i] = static_cast<std::uint8_t>(value >> (8 * (octets - 1 - i)));
            }
            return true;
        }
    }
    return false;
}

/// What the frame says now instead; what it said when nothing could be altered.
double FrameForger::altered(iec61850::Asdu const& asdu) {
    if (attack_.params().kind == Kind::counter_jump) {
        std::int64_t const wrap = std::llround(rate_hz_);
        std::int64_t const jumped = (asdu.smp_cnt + attack_.params().jump + wrap) % wrap;
        return static_cast<double>(rewrite(asdu, kSmpCnt, 2, static_cast<std::uint64_t>(jumped)) ? jumped
                                                                                                 : asdu.smp_cnt);
    }
    auto const says = static_cast<std::uint8_t>(attack_.params().smp_synch);
    return rewrite(asdu, kSmpSynch, 1, says) ? says : asdu.smp_synch;
}

void FrameForger::pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) {
    delay_ns_ = 0;
    if (time_ns < 0 || !target_.decode(frame, decoded_)) {
        if (emit) {
            emit(frame);
        }
        return;
    }
    if (condition_ && condition_->met(frame, time_ns)) {
        attack_.trigger(time_ns);
    }
    Kind const kind = attack_.params().kind;
    if (kind == Kind::flood) { // copies go out in elapse()
        buffer_.assign(frame.begin(), frame.end());
        newest_.clear();
        for (iec61850::Asdu const& asdu : decoded_.view()) {
            newest_.push_back(iec61850::absolute_index(asdu.smp_cnt, rate_hz_, time_ns));
        }
        copies_ = 0;
    }
    if (!emit) {
        return;
    }
    FrameAttack::Outcome const outcome = attack_.pass(time_ns);
    delay_ns_ = outcome.delay_ns;
    if (!outcome.acts) {
        emit(frame);
        return;
    }
    bool const rewritten = kind == Kind::counter_jump || kind == Kind::synch;
    if (rewritten) {
        buffer_.assign(frame.begin(), frame.end());
    }
    bool acted = false;
    for (iec61850::Asdu const& asdu : decoded_.view()) {
        Label label{iec61850::absolute_index(asdu.smp_cnt, rate_hz_, time_ns), kWholeFrame, 1,
                    0}; // dropped: one, and none
        if (kind == Kind::delay) {
            label.true_a = 0;
            label.sent_a = static_cast<double>(outcome.delay_ns) * 1e-9;
        } else if (rewritten) {
            label.true_a = kind == Kind::synch ? asdu.smp_synch : asdu.smp_cnt;
            label.sent_a = altered(asdu);
        }
        if (label.sent_a != label.true_a) {
            tell(label);
            acted = true;
        }
    }
    forged_.fetch_add(acted ? 1U : 0U, std::memory_order_relaxed);
    if (!outcome.dropped) {
        emit(rewritten ? iec61850::Octets{buffer_} : frame);
    }
}

void FrameForger::elapse(std::int64_t now_ns, Emit const& emit, Tell const& tell) {
    delay_ns_ = 0;
    while (due() && *due() <= now_ns) {
        attack_.copied();
        if (newest_.empty()) {
            continue; // nothing was heard yet
        }
        if (!in_cable_ && !spoof_ && source_) {
            std::copy(source_->octets.begin(), source_->octets.end(), buffer_.begin() + kSourceAt);
        }
        ++copies_;
        for (std::int64_t const index : newest_) {
            tell(Label{index, kWholeFrame, 1, static_cast<double>(1 + copies_)});
        }
        forged_.fetch_add(1, std::memory_order_relaxed);
        emit(buffer_);
    }
}

} // namespace gridspace::attacker
