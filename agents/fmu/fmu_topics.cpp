// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_topics.hpp"

#include "agents/fmu/fmu_declaration.hpp"
#include "agents/fmu/fmu_values.hpp"
#include "bus/key_hash.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <tuple>

namespace gridspace::agents {
namespace {

/// A type is known to DDS by its name and size.
bus::Codec codec_of(gateways::TopicFields const& type, std::string_view name) {
    bus::Codec codec;
    codec.type_name = name;
    codec.keyed = type.type->keyed();
    codec.max_size = type.type->max_octets();
    return codec;
}

std::vector<mapping::Value> zeros(std::vector<mapping::Field> const& fields) {
    std::vector<mapping::Value> out;
    for (mapping::Field const& field : fields) {
        out.push_back({field.type, 0, 0, {}});
    }
    return out;
}

} // namespace

Result<std::unique_ptr<FmuTopics>> FmuTopics::open(bus::Node& node, FmuConfig const& config, FmuTable& table,
                                                   fmi::ModelDescription const& description) {
    std::unique_ptr<FmuTopics> out{new FmuTopics{node, config}};
    auto ok = out->open_inputs(table);
    ok = ok ? out->open_outputs(table) : ok;
    ok = ok ? out->open_signals(config, table, description) : ok;
    return ok ? Result<std::unique_ptr<FmuTopics>>{std::move(out)} : std::unexpected{ok.error()};
}

Result<void> FmuTopics::open_inputs(FmuTable& table) {
    for (FmuTable::Input& input : table.inputs) {
        auto known = std::find_if(readers_.begin(), readers_.end(),
                                  [&](Reader const& r) { return r.topic == input.from.topic.name; });
        if (known == readers_.end()) {
            auto reader = node_.cdr_reader(input.from.topic.name, codec_of(input.type, input.from.type.name));
            if (!reader) {
                return std::unexpected{reader.error()};
            }
            known = readers_.insert(readers_.end(), {input.from.topic.name, std::move(*reader), std::nullopt});
        }
        inputs_.push_back({&input, static_cast<std::size_t>(known - readers_.begin()),
                           mapping::RecordReader{*input.type.type}, zeros(input.type.fields), zeros(table.variables)});
    }
    return {};
}

Result<void> FmuTopics::open_outputs(FmuTable& table) {
    for (FmuTable::Output& output : table.outputs) {
        auto& writer = writers_[output.topic];
        if (writer == nullptr) {
            auto made = node_.cdr_writer(output.topic, codec_of(output.type, output.type_name));
            if (!made) {
                return std::unexpected{made.error()};
            }
            writer = std::move(*made);
        }
        outputs_.push_back({&output, writer.get(), mapping::RecordWriter{*output.type.type, output.written}});
    }
    return {};
}

Result<void> FmuTopics::open_signals(FmuConfig const& config, FmuTable const& table,
                                     fmi::ModelDescription const& description) {
    watched_ = table.watched;
    if (watched_.empty()) {
        return {};
    }
    std::vector<program::Signal> const declared = declaration(config, description, table).signals;
    auto signals = bus::SignalPublisher::create(node_, "agent", declared, {});
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    signals_ = std::move(*signals);
    row_.assign(watched_.size(), 0);
    return {};
}

void FmuTopics::announce(SimTime now) {
    if (signals_ != nullptr) {
        signals_->announce(now);
    }
}

std::vector<FmuTopics::Arrival> FmuTopics::arrived() {
    std::vector<Arrival> out;
    for (std::size_t i = 0; i < readers_.size(); ++i) {
        for (auto& received : readers_[i].samples->take()) {
            out.push_back({received.origin, i, std::move(received.value.cdr)});
        }
    }
    std::sort(out.begin(), out.end(), [](Arrival const& a, Arrival const& b) {
        return std::tie(a.origin, a.reader) < std::tie(b.origin, b.reader);
    });
    return out;
}

void FmuTopics::read(Arrival const& arrival, Input const& input) {
    for (Fed& fed : inputs_) {
        if (fed.reader != arrival.reader) {
            continue;
        }
        if (!fed.record.read(arrival.cdr, fed.fields)) {
            if (!std::exchange(misfit_said_, true)) {
                log::warning("a sample of '{}' does not fit its type {}: not used (said once)",
                             fed.table->from.topic.name, fed.table->from.type.name);
            }
            continue;
        }
        bool const wanted =
            std::all_of(fed.table->filters.begin(), fed.table->filters.end(),
                        [&](FmuTable::Filter const& filter) { return fed.fields[filter.field] == filter.value; });
        if (!wanted) {
            continue;
        }
        fed.table->rules.apply(fed.fields, fed.variables);
        for (std::size_t const at : fed.table->written) {
            input(at, to_fmi(fed.variables[at]));
        }
        std::optional<SimTime>& newest = readers_[arrival.reader].newest;
        newest = newest ? std::max(*newest, arrival.origin.time) : arrival.origin.time;
    }
}

bool FmuTopics::came_after(SimTime time) const {
    return std::all_of(readers_.begin(), readers_.end(),
                       [&](Reader const& reader) { return reader.newest && *reader.newest >= time; });
}

void FmuTopics::write(SimTime point, std::span<mapping::Value const> values) {
    SimTime const effect = node_.effect_time(point, latency_);
    for (Output& output : outputs_) {
        std::span<mapping::Value> const fields = output.record.values();
        output.table->rules.apply(values, fields);
        warn_of_long_texts(*output.table, fields);
        if (output.table->time_field) {
            fields[*output.table->time_field] =
                mapping::Value::integer(mapping::BasicType::int64, node_.time_base().nanoseconds(effect));
        }
        bool const keyed = output.table->type.type->keyed();
        bus::KeyHash hash{};
        if (keyed) {
            hash = bus::key_hash(output.record.write_key(), output.record.key_is_short());
        }
        output.writer->write(output.record.write(), effect, keyed ? &hash : nullptr);
    }
    if (signals_ != nullptr) {
        for (std::size_t i = 0; i < watched_.size(); ++i) {
            row_[i] = values[watched_[i]].number();
        }
        signals_->row(node_.effect_time(point, SimSpan{}), row_);
    }
}

void FmuTopics::warn_of_long_texts(FmuTable::Output const& output, std::span<mapping::Value const> fields) {
    for (std::size_t const at : output.written) {
        mapping::Field const& field = output.type.fields[at];
        if (field.type == mapping::BasicType::visible_string && fields[at].text.size() > field.length &&
            !std::exchange(cut_said_, true)) {
            log::warning("a text of {} octets is cut to the {} that '{}' of topic '{}' has (said once)",
                         fields[at].text.size(), field.length, field.name, output.topic);
        }
    }
}

void FmuTopics::flush() {
    if (signals_ != nullptr) {
        signals_->flush();
    }
}

} // namespace gridspace::agents
