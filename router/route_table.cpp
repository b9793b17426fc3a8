// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "router/route_table.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace gridspace::router {
namespace {

constexpr std::size_t kMaxNotes = 1000;

bool contains(std::vector<std::size_t> const& list, std::size_t value) {
    return std::find(list.begin(), list.end(), value) != list.end();
}

/// What all of them offer: a reader that asks for more would not match some.
void weaken(bus::EndpointQos& qos, bus::EndpointQos const& other) {
    qos.reliable = qos.reliable && other.reliable;
    qos.durability = std::min(qos.durability, other.durability);
    qos.deadline_s = qos.deadline_s < 0 || other.deadline_s < 0 ? -1 : std::max(qos.deadline_s, other.deadline_s);
}

bool in_partition(bus::EndpointQos const& qos) {
    return std::any_of(qos.partitions.begin(), qos.partitions.end(),
                       [](std::string const& name) { return !name.empty(); });
}

/// Why the router's readers get nothing of a writer; empty: they do.
std::string unheard(bus::EndpointQos const& qos) {
    if (qos.exclusive) {
        return "it has exclusive ownership";
    }
    if (in_partition(qos)) {
        return fmt::format("it is in the partition{} {}", qos.partitions.size() == 1 ? "" : "s",
                           join(qos.partitions, ", "));
    }
    switch (qos.representations.front()) { // a writer uses the first
    case bus::Representation::xcdr1:
        return "";
    case bus::Representation::xcdr2:
        return "it writes XCDR2";
    case bus::Representation::xml:
        return "it writes XML";
    }
    return "";
}

} // namespace

bool same_route(Route const& a, Route const& b) {
    return std::tie(a.topic, a.from, a.to, a.type, a.keyed, a.qos.reliable, a.qos.durability, a.qos.deadline_s) ==
           std::tie(b.topic, b.from, b.to, b.type, b.keyed, b.qos.reliable, b.qos.durability, b.qos.deadline_s);
}

RouteTable::RouteTable(RouterConfig const& config) : config_{config} {}

bool RouteTable::takes(std::size_t end, std::string const& program) const {
    return config_.ends[end].link.has_value() || program != kProgram;
}

void RouteTable::participant_found(std::size_t, std::string const& id, std::string const& program) {
    programs_[id] = program;
}

void RouteTable::participant_gone(std::string const& id) {
    programs_.erase(id);
    std::erase_if(writers_, [&](auto const& entry) { return entry.second.endpoint.participant == id; });
}

void RouteTable::endpoint_found(std::size_t end, bus::DiscoveredEndpoint const& endpoint) {
    auto const program = programs_.find(endpoint.participant);
    if (!endpoint.writer || program == programs_.end()) {
        return; // others are reported before their endpoints: this one is our own
    }
    auto const topic = std::find_if(config_.topics.begin(), config_.topics.end(),
                                    [&](TopicConfig const& t) { return t.name == endpoint.topic; });
    if (topic == config_.topics.end()) {
        return;
    }
    if (!takes(end, program->second)) {
        if (contains(topic->to, end)) {
            note(fmt::format("another router carries '{}' to {} too: readers there may hear samples twice",
                             endpoint.topic, config_.ends[end].name.name));
        }
        return;
    }
    if (!contains(topic->from, end)) {
        return;
    }
    if (std::string const why = unheard(endpoint.qos); !why.empty()) {
        writers_.erase(endpoint.id); // it may have changed its partition
        note(fmt::format("a writer of '{}' on {} is not heard: {}", endpoint.topic, config_.ends[end].name.name, why));
        return;
    }
    auto const known = writers_.find(endpoint.id);
    writers_.insert_or_assign(endpoint.id,
                              Writer{end, endpoint, known == writers_.end() ? found_++ : known->second.order});
}

void RouteTable::endpoint_gone(std::string const& id) {
    writers_.erase(id);
}

std::vector<Route> RouteTable::routes() const {
    std::vector<Writer const*> in_order;
    for (auto const& [id, writer] : writers_) {
        in_order.push_back(&writer);
    }
    std::sort(in_order.begin(), in_order.end(), [](Writer const* a, Writer const* b) { return a->order < b->order; });

    std::vector<Route> out;
    for (TopicConfig const& topic : config_.topics) {
        for (std::size_t const from : topic.from) {
            Route route;
            bool found = false;
            for (Writer const* writer : in_order) {
                bus::DiscoveredEndpoint const& endpoint = writer->endpoint;
                if (writer->end != from || endpoint.topic != topic.name || (found && endpoint.type != route.type)) {
                    continue;
                }
                if (!found) {
                    route.topic = topic.name;
                    route.from = from;
                    route.type = endpoint.type;
                    route.keyed = endpoint.keyed;
                    route.qos = endpoint.qos;
                    route.depth = static_cast<std::int32_t>(topic.depth);
                    found = true;
                } else {
                    weaken(route.qos, endpoint.qos);
                }
            }
            for (std::size_t const to : topic.to) {
                bool const from_link_to_link = config_.ends[from].link && config_.ends[to].link;
                if (to != from && !from_link_to_link) {
                    route.to.push_back(to);
                }
            }
            if (found && !route.to.empty()) {
                out.push_back(std::move(route));
            }
        }
    }
    return out;
}

void RouteTable::note(std::string text) {
    if (noted_.size() < kMaxNotes && noted_.insert(text).second) { // partitions have whatever names
        notes_.push_back(std::move(text));
        if (noted_.size() == kMaxNotes) {
            notes_.push_back(fmt::format("{} notes have been made; there will be no more", kMaxNotes));
        }
    }
}

std::vector<std::string> RouteTable::take_notes() {
    return std::exchange(notes_, {});
}

} // namespace gridspace::router
