// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/sv_forger.hpp"

#include "gateways/iec61850/sample_index.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {

std::vector<std::string> phase_channels(streams::Stream const& stream) {
    std::vector<std::string> out;
    for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream.data_set)) {
        if (iec61850::is_number(leaf.type) && out.size() < 3) {
            out.push_back(leaf.name);
        }
    }
    return out;
}

Result<std::unique_ptr<SvForger>> SvForger::create(streams::Stream const& stream, AttackConfig const& config,
                                                   double frequency_hz, std::uint64_t seed) {
    std::vector<std::string> const phases = phase_channels(stream);
    if (phases.size() != 3) {
        return fail(ExitCode::usage,
                    fmt::format("attack '{}': stream '{}' has {} numbers, and three currents are attacked",
                                config.name.name, stream.name.name, phases.size()));
    }
    auto attack = make_sample_attack(config, phases, stream.rate_hz.to_double(), frequency_hz, seed);
    if (!attack) {
        return std::unexpected{attack.error()};
    }
    auto frame = stream.sv_template({});
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    auto out = std::unique_ptr<SvForger>{new SvForger{stream, config, std::move(*attack), std::move(*frame)}};
    for (std::size_t p = 0; p < 3; ++p) {
        out->slots_[p] = *out->target_.layout().index_of(phases[p]);
        out->scales_[p] = out->target_.amperes(out->slots_[p]);
    }
    return out;
}

SvForger::SvForger(streams::Stream const& stream, AttackConfig const& config, SampleAttack attack,
                   iec61850::SvTemplate frame)
    : target_{stream}, rate_hz_{stream.rate_hz.to_double()}, anticipation_{attack}, attack_{std::move(attack)},
      template_{std::move(frame)}, spoof_{config.spoof} {
    buffer_.reserve(2048);
    last_sample_.resize(target_.layout().sample_octets());
}

Abc SvForger::read(iec61850::Octets sample) const {
    Abc out;
    for (std::size_t p = 0; p < 3; ++p) {
        out[p] = target_.layout().read(slots_[p], sample).number() * scales_[p];
    }
    return out;
}

double SvForger::write(std::size_t phase, double value_a, std::span<std::uint8_t> sample) const {
    auto const type = target_.layout().slots()[slots_[phase]].leaf.type;
    auto const value = iec61850::Value::from_number(type, value_a / scales_[phase]);
    target_.layout().write(slots_[phase], value, sample);
    return value.number() * scales_[phase];
}

void SvForger::pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) {
    if (time_ns < 0 || !target_.decode(frame, decoded_)) {
        emit(frame);
        return;
    }
    buffer_.assign(frame.begin(), frame.end());
    bool altered = false;
    for (iec61850::Asdu const& asdu : decoded_.view()) {
        std::int64_t const index = iec61850::absolute_index(asdu.smp_cnt, rate_hz_, time_ns);
        Abc const true_a = read(asdu.sample);
        SampleAttack::Outcome outcome = attack_.apply(index, true_a);
        std::span<std::uint8_t> const sample{buffer_.data() + (asdu.sample.data() - frame.data()), asdu.sample.size()};
        for (std::size_t p = 0; p < 3; ++p) {
            if ((outcome.altered & (1U << p)) != 0) {
                outcome.sent_a[p] = write(p, outcome.sent_a[p], sample);
            }
        }
        labels_of(index, true_a, outcome, tell);
        altered = altered || outcome.altered != 0;
    }
    forged_.fetch_add(altered ? 1U : 0U, std::memory_order_relaxed);
    emit(buffer_);
}

void SvForger::hear(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) {
    if (time_ns < 0 || !target_.decode(frame, decoded_)) {
        return;
    }
    for (iec61850::Asdu const& asdu : decoded_.view()) {
        anticipation_.real(iec61850::absolute_index(asdu.smp_cnt, rate_hz_, time_ns), read(asdu.sample), tell);
        std::copy(asdu.sample.begin(), asdu.sample.end(), last_sample_.begin());
    }
    if (spoof_) {
        template_.set_source(decoded_.header.source);
    }
    forge_next(emit);
}

void SvForger::forge_next(Emit const& emit) {
    bool altered = false;
    std::array<Anticipation::Forged, iec61850::SvTemplate::kMaxAsdusSent> all{};
    for (std::size_t i = 0; i < template_.asdus(); ++i) {
        auto const forged = anticipation_.next();
        if (!forged) {
            return;
        }
        all[i] = *forged;
        altered = altered || forged->altered != 0;
        std::span<std::uint8_t> const sample = template_.sample(i);
        std::copy(last_sample_.begin(), last_sample_.end(),
                  sample.begin()); // quality and all else as the real one has it
        for (std::size_t p = 0; p < 3; ++p) {
            all[i].sent_a[p] = write(p, forged->sent_a[p], sample);
        }
        template_.set_smp_cnt(i, static_cast<std::uint16_t>(forged->index % std::llround(rate_hz_)));
    }
    if (!altered) {
        return;
    }
    for (std::size_t i = 0; i < template_.asdus(); ++i) {
        anticipation_.sent(all[i]);
    }
    forged_.fetch_add(1, std::memory_order_relaxed);
    emit(template_.frame());
}

} // namespace gridspace::attacker
