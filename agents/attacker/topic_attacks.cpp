// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/topic_attacks.hpp"

#include "agents/attacker/anticipation.hpp"
#include "agents/attacker/goose_attack.hpp"

#include <protection.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

class CurrentsAttack final : public TopicAttack {
  public:
    CurrentsAttack(bus::Node& node, AttackConfig const& config, AttackerSettings const& settings)
        : node_{node}, config_{config}, settings_{settings} {}
    Result<void> open() {
        auto reader = node_.reader<LineCurrents>(config_.topic.name);
        auto writer = node_.writer<LineCurrents>(config_.topic.name);
        if (!reader || !writer) {
            return std::unexpected{!reader ? reader.error() : writer.error()};
        }
        reader_ = std::move(*reader);
        writer_ = std::move(*writer);
        return {};
    }

    void work(std::int64_t, SimSpan latency, TellAt const& tell) override {
        for (auto const& received : reader_->take()) {
            LineCurrents const& real = received.value;
            if (!anticipation_ && !begin(real)) {
                continue;
            }
            auto index = static_cast<std::int64_t>(real.first_index());
            auto const tell_now = [&, at = node_.time_base().nanoseconds(received.origin.time)](Label const& label) {
                tell(label, at);
            };
            for (PhaseCurrents const& i : real.samples()) {
                anticipation_->real(index++, {i.ia(), i.ib(), i.ic()}, tell_now);
            }
            forge(real, node_.effect_time(received.origin.time, latency));
        }
    }
    [[nodiscard]] bool works_in_every_tick() const override { return node_.is_of_simulator(config_.topic.name); }
    [[nodiscard]] std::uint64_t forged() const override { return forged_; }

  private:
    bool begin(LineCurrents const& real) {
        double const rate_hz = static_cast<double>(real.rate_num()) / real.rate_den();
        auto attack = make_sample_attack(config_, {"Ia", "Ib", "Ic"}, rate_hz, settings_.frequency_hz,
                                         static_cast<std::uint64_t>(settings_.seed));
        if (!attack) {
            node_.fail_with(attack.error());
            return false;
        }
        anticipation_.emplace(std::move(*attack));
        return true;
    }

    void forge(LineCurrents const& real, SimTime at) {
        LineCurrents message;
        message.transformer(real.transformer());
        message.rate_num(real.rate_num());
        message.rate_den(real.rate_den());
        bool altered = false;
        for (std::size_t n = 0; n < real.samples().size(); ++n) {
            auto next = anticipation_->next();
            if (!next) {
                return;
            }
            if (n == 0) {
                message.first_index(static_cast<std::uint64_t>(next->index));
            }
            PhaseCurrents i;
            i.ia(static_cast<float>(next->sent_a[0]));
            i.ib(static_cast<float>(next->sent_a[1]));
            i.ic(static_cast<float>(next->sent_a[2]));
            next->sent_a = {i.ia(), i.ib(), i.ic()};
            message.samples().push_back(i);
            double const time_s = static_cast<double>(next->index) * real.rate_den() / real.rate_num();
            message.time_ns(std::llround(time_s * 1e9));
            altered = altered || next->altered != 0;
            forged_now_.push_back(*next);
        }
        if (altered) {
            for (Anticipation::Forged const& f : forged_now_) {
                anticipation_->sent(f);
            }
            writer_->write(message, at);
            ++forged_;
        }
        forged_now_.clear();
    }

    bus::Node& node_;
    AttackConfig const& config_;
    AttackerSettings const& settings_;
    std::shared_ptr<bus::Reader<LineCurrents>> reader_;
    std::unique_ptr<bus::Writer<LineCurrents>> writer_;
    std::optional<Anticipation> anticipation_;
    std::vector<Anticipation::Forged> forged_now_;
    std::uint64_t forged_{0};
};

/// A trip command is a message with one Boolean, and is attacked like one; numbers of state and time mean nothing in
/// it.
class CommandAttack final : public TopicAttack {
  public:
    CommandAttack(bus::Node& node, AttackConfig const& config, AttackerSettings const& settings)
        : node_{node}, config_{config},
          attack_{*config.goose, times_in_ns(config), static_cast<std::uint64_t>(settings.seed)} {}
    Result<void> open() {
        auto reader = node_.reader<TripCommand>(config_.topic.name);
        auto writer = node_.writer<TripCommand>(config_.topic.name);
        if (!reader || !writer) {
            return std::unexpected{!reader ? reader.error() : writer.error()};
        }
        reader_ = std::move(*reader);
        writer_ = std::move(*writer);
        (void)attack_.pass(-1, {}); // before anybody has commanded anything, no trip is what is real
        return {};
    }

    void work(std::int64_t until_ns, SimSpan latency, TellAt const& tell) override {
        for (auto const& received : reader_->take()) {
            std::int64_t const at_ns = node_.time_base().nanoseconds(received.origin.time);
            elapse(std::min(at_ns - 1, until_ns), latency, tell);
            GooseState real;
            real.st_num = ++states_;
            real.value = received.value.status();
            (void)attack_.pass(at_ns, real);
            real_ = real.value;
            source_ = received.value.source().c_str();
        }
        elapse(until_ns, latency, tell);
    }
    [[nodiscard]] std::optional<std::int64_t> due() const override { return attack_.next_ns(); }
    [[nodiscard]] std::uint64_t forged() const override { return attack_.forged(); }

  private:
    void elapse(std::int64_t until_ns, SimSpan latency, TellAt const& tell) {
        for (auto due = attack_.next_ns(); due && *due <= until_ns; due = attack_.next_ns()) {
            std::int64_t const now_ns = *due;
            auto const state = attack_.forge(now_ns);
            if (!state) {
                continue;
            }
            SimTime when = node_.time_base().from_nanoseconds(now_ns);
            when.quanta += node_.time_base().nanoseconds(when) < now_ns ? 1 : 0;
            SimTime const effect = node_.effect_time(when, latency);
            TripCommand command;
            command.source(source_.empty() ? node_.config().process.c_str() : source_.c_str());
            command.time_ns(node_.time_base().nanoseconds(effect));
            command.status(state->value);
            writer_->write(command, effect);
            tell(Label{labels_++, 0, real_ ? 1.0 : 0.0, state->value ? 1.0 : 0.0}, now_ns);
        }
    }

    bus::Node& node_;
    AttackConfig const& config_;
    GooseAttack attack_;
    std::shared_ptr<bus::Reader<TripCommand>> reader_;
    std::unique_ptr<bus::Writer<TripCommand>> writer_;
    std::string source_;
    std::uint32_t states_{1};
    std::int64_t labels_{0};
    bool real_{false};
};

template <class T>
Result<std::unique_ptr<TopicAttack>> opened(bus::Node& node, AttackConfig const& config,
                                            AttackerSettings const& settings) {
    auto attack = std::make_unique<T>(node, config, settings);
    if (auto ok = attack->open(); !ok) {
        return std::unexpected{ok.error()};
    }
    return attack;
}

} // namespace

Result<std::unique_ptr<TopicAttack>> make_topic_attack(bus::Node& node, AttackConfig const& config,
                                                       AttackerSettings const& settings) {
    auto const type = settings.topic_types.find(config.topic.name);
    std::string const name = type == settings.topic_types.end() ? "" : type->second;
    if (name == "LineCurrents" && !config.goose && !config.frames) {
        return opened<CurrentsAttack>(node, config, settings);
    }
    if (name == "TripCommand" && config.goose) {
        return opened<CommandAttack>(node, config, settings);
    }
    return fail(
        ExitCode::usage,
        fmt::format("attack '{}': nothing is known about '{}' of type '{}'", config.name.name, config.topic.name, name),
        "`value` goes with LineCurrents, `message` with TripCommand");
}

} // namespace gridspace::attacker
