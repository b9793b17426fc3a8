// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// How a member opens what the program's description names.
#include "sdk/agent_member.hpp"

#include "sdk/described_settings.hpp"

#include <fmt/format.h>

namespace gridspace::sdk {
namespace {

Result<std::shared_ptr<TopicType const>> load_type(program::Topic const& topic, std::filesystem::path const& folder) {
    return TopicType::load(topic.type, topic.idl.empty() ? std::filesystem::path{} : folder / topic.idl);
}

/// A topic or stream with its pattern filled in, and the pattern.
struct Named {
    std::string declared;
    program::Topic topic;
};

std::vector<Named> named(std::vector<program::Topic> const& topics, program::Values const& values, bool streams) {
    std::vector<Named> out;
    for (program::Topic const& one : topics) {
        for (program::Topic& topic : program::expand(std::vector{one}, values)) {
            if (topic.is_stream == streams) {
                out.push_back({one.topic, std::move(topic)});
            }
        }
    }
    return out;
}

template <class Ends>
std::string topics_of(Ends const& ends) {
    std::string out;
    for (auto const& end : ends) {
        out += fmt::format(R"({}{{"topic":"{}","declared":"{}","type":"{}","layout":{}}})", out.empty() ? "" : ",",
                           end.topic, end.declared, end.type->name(), end.type->layout_json());
    }
    return out;
}

} // namespace

Result<void> AgentMember::prepare() {
    program::Values const values = values_of(settings_, node_.config().process);
    for (auto const open : {&AgentMember::open_reads, &AgentMember::open_writes, &AgentMember::open_streams,
                            &AgentMember::open_signals}) {
        if (auto ok = (this->*open)(values); !ok) {
            return ok;
        }
    }
    describe_topics();
    return {};
}

Result<void> AgentMember::open_reads(program::Values const& values) {
    for (auto const& [declared, topic] : named(program_.declaration.reads, values, false)) {
        auto const type = load_type(topic, program_.folder);
        if (!type) {
            return std::unexpected{type.error()};
        }
        auto filter = SampleFilter::create((*type)->layout(), topic.only, values);
        if (!filter) {
            return fail(filter.error().code, fmt::format("topic '{}': {}", topic.topic, filter.error().message));
        }
        auto inbox = std::make_shared<SampleInbox>(*type, std::move(*filter));
        if (auto ok = node_.reader(topic.topic, (*type)->codec(), inbox); !ok) {
            return ok;
        }
        readers_.push_back({declared, topic.topic, *type, std::move(inbox)});
        works_in_every_tick_ |= topic.triggers && node_.is_of_simulator(topic.topic);
    }
    return {};
}

Result<void> AgentMember::open_writes(program::Values const& values) {
    for (auto const& [declared, topic] : named(program_.declaration.writes, values, false)) {
        auto const type = load_type(topic, program_.folder);
        if (!type) {
            return std::unexpected{type.error()};
        }
        auto writer = node_.cdr_writer(topic.topic, (*type)->codec());
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        writers_.push_back({declared, topic.topic, *type, std::move(*writer)});
    }
    return {};
}

Result<void> AgentMember::open_streams(program::Values const& values) {
    auto const read = named(program_.declaration.reads, values, true);
    auto const written = named(program_.declaration.writes, values, true);
    if (read.empty() && written.empty()) {
        return {};
    }
    auto const names_of = [](std::vector<Named> const& ends) {
        std::vector<std::string> out;
        for (Named const& end : ends) {
            out.push_back(end.topic.topic);
        }
        return out;
    };
    auto streams =
        StreamEnds::open(node_, wire_, latency_, names_of(read), names_of(written), static_cast<int>(readers_.size()));
    if (!streams) {
        return std::unexpected{streams.error()};
    }
    streams_ = std::move(*streams);
    for (std::size_t i = 0; i < read.size(); ++i) {
        readers_.push_back({read[i].declared, read[i].topic.topic, streams_->reads()[i].type, nullptr});
    }
    for (std::size_t i = 0; i < written.size(); ++i) {
        writers_.push_back({written[i].declared, written[i].topic.topic, streams_->writes()[i].type, nullptr, i});
    }
    return {};
}

Result<void> AgentMember::open_signals(program::Values const& values) {
    std::vector<program::Signal> const& declared = program_.declaration.signals;
    std::map<std::string, Origin> origins;
    for (program::Signal const& signal : declared) {
        std::vector<std::string> const names = program::expand(signal.name, values),
                                       of = program::placeholder_values(signal.name, values);
        for (std::size_t i = 0; i < names.size(); ++i) {
            origins[names[i]] = {signal.name, of[i]};
        }
    }
    for (program::Signal& signal : program::expand(declared, values)) {
        origins_.push_back(origins.at(signal.name));
        columns_.push_back({std::move(signal.name), std::move(signal.unit)});
    }
    if (columns_.empty()) {
        return {};
    }
    auto signals = bus::SignalPublisher::create(node_, "agent", declared.front().rate_hz, columns_);
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    signals_ = std::move(*signals);
    row_.assign(columns_.size(), 0);
    return {};
}

void AgentMember::describe_topics() {
    std::string signals;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        signals += fmt::format(R"({}{{"name":"{}","unit":"{}","declared":"{}","value":"{}"}})", i == 0 ? "" : ",",
                               columns_[i].name, columns_[i].unit, origins_[i].declared, origins_[i].value);
    }
    topics_json_ = fmt::format(R"({{"reads":[{}],"writes":[{}],"signals":[{}]}})", topics_of(readers_),
                               topics_of(writers_), signals);
}

} // namespace gridspace::sdk
