// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/match.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fnmatch.h>

namespace gridspace::graph {
namespace {

std::string duration_text(double seconds) {
    return seconds < 0 ? "infinite" : shortest(seconds) + " s";
}

/// Partition names are patterns on either side, not on both (DDS 1.4, 2.2.3.13).
bool partitions_meet(std::vector<std::string> a, std::vector<std::string> b) {
    a = a.empty() ? std::vector<std::string>{""} : std::move(a);
    b = b.empty() ? std::vector<std::string>{""} : std::move(b);
    return std::any_of(a.begin(), a.end(), [&](std::string const& x) {
        return std::any_of(b.begin(), b.end(), [&](std::string const& y) {
            return x == y || ::fnmatch(x.c_str(), y.c_str(), 0) == 0 || ::fnmatch(y.c_str(), x.c_str(), 0) == 0;
        });
    });
}

std::string representation_names(std::vector<bus::Representation> const& all) {
    std::vector<std::string> names;
    for (bus::Representation const one : all) {
        names.emplace_back(name_of(one));
    }
    return join(names, " or ");
}

} // namespace

char const* name_of(bus::Durability durability) {
    switch (durability) {
    case bus::Durability::volatile_:
        return "volatile";
    case bus::Durability::transient_local:
        return "transient local";
    case bus::Durability::transient:
        return "transient";
    case bus::Durability::persistent:
        return "persistent";
    }
    return "unknown";
}

char const* name_of(bus::Liveliness liveliness) {
    switch (liveliness) {
    case bus::Liveliness::automatic:
        return "automatic";
    case bus::Liveliness::manual_by_participant:
        return "manual by participant";
    case bus::Liveliness::manual_by_topic:
        return "manual by topic";
    }
    return "unknown";
}

char const* name_of(bus::PresentationScope scope) {
    switch (scope) {
    case bus::PresentationScope::instance:
        return "instance";
    case bus::PresentationScope::topic:
        return "topic";
    case bus::PresentationScope::group:
        return "group";
    }
    return "unknown";
}

char const* name_of(bus::Representation representation) {
    switch (representation) {
    case bus::Representation::xcdr1:
        return "XCDR1";
    case bus::Representation::xml:
        return "XML";
    case bus::Representation::xcdr2:
        return "XCDR2";
    }
    return "unknown";
}

std::vector<std::string> mismatch(bus::DiscoveredEndpoint const& writer, bus::DiscoveredEndpoint const& reader) {
    std::vector<std::string> reasons;
    bus::EndpointQos const &offered = writer.qos, &requested = reader.qos;
    auto const later = [](double offer, double request) { return request >= 0 && (offer < 0 || offer > request); };
    if (writer.type != reader.type) {
        reasons.push_back(fmt::format("type: written is {}, read is {}", writer.type, reader.type));
    }
    if (writer.keyed != reader.keyed) {
        reasons.push_back(fmt::format("key: the writer {} one, the reader {}", writer.keyed ? "has" : "has not",
                                      reader.keyed ? "has" : "has not"));
    }
    if (!offered.reliable && requested.reliable) {
        reasons.emplace_back("reliability: offered is best effort, requested is reliable");
    }
    if (offered.durability < requested.durability) {
        reasons.push_back(fmt::format("durability: offered is {}, requested is {}", name_of(offered.durability),
                                      name_of(requested.durability)));
    }
    if (later(offered.deadline_s, requested.deadline_s)) {
        reasons.push_back(fmt::format("deadline: offered is {}, requested is {}", duration_text(offered.deadline_s),
                                      duration_text(requested.deadline_s)));
    }
    if (later(offered.latency_budget_s, requested.latency_budget_s)) {
        reasons.push_back(fmt::format("latency budget: offered is {}, requested is {}",
                                      duration_text(offered.latency_budget_s),
                                      duration_text(requested.latency_budget_s)));
    }
    if (offered.liveliness < requested.liveliness) {
        reasons.push_back(fmt::format("liveliness: offered is {}, requested is {}", name_of(offered.liveliness),
                                      name_of(requested.liveliness)));
    }
    if (later(offered.lease_s, requested.lease_s)) {
        reasons.push_back(fmt::format("liveliness lease: offered is {}, requested is {}",
                                      duration_text(offered.lease_s), duration_text(requested.lease_s)));
    }
    if (offered.exclusive != requested.exclusive) {
        reasons.push_back(fmt::format("ownership: offered is {}, requested is {}",
                                      offered.exclusive ? "exclusive" : "shared",
                                      requested.exclusive ? "exclusive" : "shared"));
    }
    if (offered.by_source_timestamp < requested.by_source_timestamp) {
        reasons.emplace_back("destination order: offered is by reception timestamp, requested is by source timestamp");
    }
    if (offered.scope < requested.scope) {
        reasons.push_back(fmt::format("presentation: offered is access by {}, requested is by {}",
                                      name_of(offered.scope), name_of(requested.scope)));
    }
    if (!offered.coherent && requested.coherent) {
        reasons.emplace_back("presentation: coherent access is requested and not offered");
    }
    if (!offered.ordered && requested.ordered) {
        reasons.emplace_back("presentation: ordered access is requested and not offered");
    }
    if (auto const& read = requested.representations;
        std::find(read.begin(), read.end(), offered.representations.front()) == read.end()) {
        reasons.push_back(fmt::format("data representation: written is {}, read is {}",
                                      name_of(offered.representations.front()), representation_names(read)));
    }
    if (!partitions_meet(offered.partitions, requested.partitions)) {
        reasons.push_back(fmt::format("partition: written to [{}], read from [{}]", join(offered.partitions, ", "),
                                      join(requested.partitions, ", ")));
    }
    return reasons;
}

} // namespace gridspace::graph
