// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/sink.hpp"
#include "gateways/iec61850/quality.hpp"
#include "gateways/mapping/record_writer.hpp"

#include <algorithm>

namespace gridspace::gateways {

using mapping::BasicType;
using mapping::Value;

Sink::Sink(Route& route) {
    for (mapping::Field const& field : route.to) {
        bool const bits = field.type == BasicType::bit_string;
        values_.push_back({field.type, bits ? static_cast<std::uint8_t>(field.length) : std::uint8_t{0}, 0, {}});
    }
    route.constants.apply({}, values_);
    for (std::size_t const field : route.invalid) {
        values_[field] = mapping::Value::quality(iec61850::quality::kInvalid);
    }
}

namespace {

class TopicSink final : public Sink {
  public:
    TopicSink(GatewayContext const& context, Route& route, bus::CdrWriter& writer)
        : Sink{route}, context_{context}, route_{route}, writer_{writer},
          record_{*route.to_type, route.written, static_cast<std::size_t>(route.config.per_message)},
          gathers_{!route.config.each.empty()}, only_changes_{route.from_stream->kind == streams::Kind::goose &&
                                                              route.config.write_on == MappingConfig::WriteOn::change},
          before_(route.written.size()), texts_(route.written.size()) {
        for (std::size_t i = 0; i < values_.size(); ++i) { // an enumeration may not know 0
            if (std::find(route.written.begin(), route.written.end(), i) == route.written.end()) {
                values_[i] = record_.values()[i];
            }
        }
        for (std::string& text : texts_) {
            text.reserve(mapping::RecordType::kTextOctets);
        }
    }

    void put(Moment at, std::int64_t index) override {
        if (only_changes_ && written_ && !changed()) {
            return;
        }
        if (record_.elements() == 0) {
            first_index_ = index;
        }
        std::copy(values_.begin(), values_.end(), record_.values().begin());
        if (gathers_) {
            (void)record_.append();
            if (record_.elements() < static_cast<std::size_t>(route_.config.per_message)) {
                return;
            }
        }
        write(at);
        remember();
    }

    void gap(Moment at) override {
        if (record_.elements() > 0) {
            write(at);
        }
    }
    void finish(Moment at) override { gap(at); }

  private:
    void write(Moment at) {
        // In real time too it says when it takes effect: should the simulator be late just now, its time is not the
        // wall's.
        SimTime const effect = context_.node.lockstep() ? context_.node.effect_time(at.time, context_.latency)
                                                        : at.time + context_.latency;
        if (route_.time_field) {
            record_.values()[*route_.time_field] =
                Value::integer(BasicType::int64, context_.node.time_base().nanoseconds(effect));
        }
        if (route_.index_field) {
            record_.values()[*route_.index_field] = {
                route_.to[*route_.index_field].type, 0, static_cast<std::uint64_t>(first_index_), {}};
        }
        bool const keyed = route_.to_type->keyed();
        bus::KeyHash hash{};
        if (keyed) {
            hash = bus::key_hash(record_.write_key(), record_.key_is_short());
        }
        writer_.write(record_.write(), effect, keyed ? &hash : nullptr);
        record_.clear_elements();
        written_ = true;
    }

    [[nodiscard]] bool changed() const {
        for (std::size_t i = 0; i < before_.size(); ++i) {
            if (!(values_[route_.written[i]] == before_[i])) {
                return true;
            }
        }
        return false;
    }
    /// Texts point into frames: they are copied.
    void remember() {
        for (std::size_t i = 0; only_changes_ && i < before_.size(); ++i) {
            before_[i] = values_[route_.written[i]];
            texts_[i].assign(reinterpret_cast<char const*>(before_[i].text.data()), before_[i].text.size());
            before_[i].text = iec61850::octets_of(texts_[i]);
        }
    }

    GatewayContext const& context_;
    Route& route_;
    bus::CdrWriter& writer_;
    mapping::RecordWriter record_;
    bool gathers_, only_changes_, written_{false};
    std::int64_t first_index_{0};
    std::vector<Value> before_;
    std::vector<std::string> texts_;
};

} // namespace

std::unique_ptr<Sink> make_topic_sink(GatewayContext const& context, Route& route, bus::CdrWriter& writer) {
    return std::make_unique<TopicSink>(context, route, writer);
}

} // namespace gridspace::gateways
