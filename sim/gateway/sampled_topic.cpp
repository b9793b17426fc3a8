// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/sampled_topic.hpp"

#include "sim/gateway/outbox.hpp"

#include <array>
#include <fmt/format.h>
#include <protection.h>

namespace gridspace::sim {
namespace {

void add(LineCurrents& message, std::array<float, 3> const& v) {
    PhaseCurrents row;
    row.ia(v[0]);
    row.ib(v[1]);
    row.ic(v[2]);
    message.samples().push_back(row);
}
void add(BaySamples& message, std::array<float, 6> const& v) {
    BayValues row;
    row.ia(v[0]);
    row.ib(v[1]);
    row.ic(v[2]);
    row.va(v[3]);
    row.vb(v[4]);
    row.vc(v[5]);
    message.samples().push_back(row);
}
void name(LineCurrents& message, LineGatewayConfig::Publish const& publish) {
    message.transformer(publish.transformer.name.c_str());
}
void name(BaySamples& message, LineGatewayConfig::Publish const& publish) {
    message.transformer(publish.transformer.name.c_str());
    message.voltage_transformer(publish.voltage.name.c_str());
}

template <class Message, std::size_t Values>
class TopicOf final : public SampledTopic {
  public:
    TopicOf(bus::Node& node, Engine& engine, std::array<std::size_t, Values> const& signals)
        : node_{node}, engine_{engine}, signals_{signals} {}

    Result<void> open(LineGatewayConfig::Publish const& publish, SamplingConfig const& sampling) {
        // In lockstep nobody may wait for a sample of a tick that is over: a message ends with its tick (flush).
        samples_per_message_ = static_cast<std::size_t>(sampling.samples_per_message);
        name(message_, publish);
        message_.rate_num(static_cast<std::uint32_t>(sampling.rate_hz.num()));
        message_.rate_den(static_cast<std::uint32_t>(sampling.rate_hz.den()));
        message_.samples().reserve(MAX_SAMPLES_PER_MESSAGE);
        auto writer = node_.writer<Message>(publish.topic.name);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        writer_ = std::move(*writer);
        if (!node_.lockstep()) {
            constexpr std::size_t kMessages = 4096; // seconds
            outbox_ = std::make_unique<Outbox<Message>>(kMessages);
        }
        return {};
    }

    void sample(SimTime t, std::uint64_t index) override {
        last_sample_ = t;
        if (message_.samples().empty()) {
            message_.first_index(index);
        }
        std::array<float, Values> values{};
        for (std::size_t i = 0; i < Values; ++i) {
            values[i] = static_cast<float>(engine_.value(signals_[i]));
        }
        add(message_, values);
        if (message_.samples().size() >= samples_per_message_) {
            flush();
        }
    }
    void flush() override {
        if (message_.samples().empty()) {
            return;
        }
        message_.time_ns(node_.time_base().nanoseconds(last_sample_));
        if (outbox_ != nullptr) {
            outbox_->put(last_sample_, message_);
        } else {
            writer_->write(message_, last_sample_);
        }
        message_.samples().clear();
    }
    void drain(SimTime until) override {
        outbox_->drain(until, [&](Message const& message, SimTime time) { writer_->write(message, time); });
    }
    [[nodiscard]] std::uint64_t lost() const override { return outbox_ == nullptr ? 0 : outbox_->lost(); }

  private:
    bus::Node& node_;
    Engine& engine_;
    std::array<std::size_t, Values> signals_;
    std::size_t samples_per_message_{1};
    SimTime last_sample_;
    Message message_;
    std::unique_ptr<bus::Writer<Message>> writer_;
    std::unique_ptr<Outbox<Message>> outbox_; ///< real time
};

template <class Topic, std::size_t Values>
Result<std::unique_ptr<SampledTopic>> open(bus::Node& node, Engine& engine, LineGatewayConfig::Publish const& publish,
                                           std::string const& gateway, SamplingConfig const& sampling) {
    std::array<std::size_t, Values> signals{};
    for (std::size_t i = 0; i < Values; ++i) {
        std::string const signal = i < 3 ? fmt::format("ct.{}.i.{}", publish.transformer.name, "abc"[i])
                                         : fmt::format("vt.{}.v.{}", publish.voltage.name, "abc"[i - 3]);
        signals[i] = engine.find_signal(signal);
        if (signals[i] == engine.signals().size()) {
            return fail(ExitCode::usage,
                        fmt::format("the solver has no signal '{}' for the gateway '{}'", signal, gateway),
                        "sampled values need `solver: emt`");
        }
    }
    auto topic = std::make_unique<Topic>(node, engine, signals);
    if (auto ok = topic->open(publish, sampling); !ok) {
        return std::unexpected{ok.error()};
    }
    return topic;
}

} // namespace

Result<std::unique_ptr<SampledTopic>> SampledTopic::create(bus::Node& node, Engine& engine,
                                                           LineGatewayConfig::Publish const& publish,
                                                           std::string const& gateway, SamplingConfig const& sampling) {
    return publish.voltage.empty() ? open<TopicOf<LineCurrents, 3>, 3>(node, engine, publish, gateway, sampling)
                                   : open<TopicOf<BaySamples, 6>, 6>(node, engine, publish, gateway, sampling);
}

} // namespace gridspace::sim
