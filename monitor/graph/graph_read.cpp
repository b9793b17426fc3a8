// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/graph_text.hpp"
#include "monitor/graph/match.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace gridspace::graph {
namespace {

/// The one of `all` that has this name; the first when none has.
template <class E>
E named(std::string const& name, std::initializer_list<E> all) {
    for (E const e : all) {
        if (name == name_of(e)) {
            return e;
        }
    }
    return *all.begin();
}

/// A natural number of the graph; another value, or one beyond T, is an error of the file. (The library's own
/// conversion of 1e40 is undefined.)
template <class T>
T natural(nlohmann::json const& json) {
    if (!json.is_number_unsigned() || !std::in_range<T>(json.get<std::uint64_t>())) {
        throw nlohmann::json::type_error::create(302, "expected a natural number", &json);
    }
    return json.get<T>();
}

double duration_of(nlohmann::json const& json) {
    return json.is_number() ? json.get<double>() : -1;
}

bus::EndpointQos qos_of(nlohmann::json const& json) {
    using bus::Durability;
    using bus::Liveliness;
    using bus::PresentationScope;
    using bus::Representation;
    bus::EndpointQos qos;
    qos.reliable = json.at("reliability") == "reliable";
    qos.durability =
        named(json.at("durability").get<std::string>(),
              {Durability::volatile_, Durability::transient_local, Durability::transient, Durability::persistent});
    qos.deadline_s = duration_of(json.at("deadline_s"));
    qos.liveliness = named(json.at("liveliness").get<std::string>(),
                           {Liveliness::automatic, Liveliness::manual_by_participant, Liveliness::manual_by_topic});
    qos.lease_s = duration_of(json.at("lease_s"));
    qos.exclusive = json.at("ownership") == "exclusive";
    json.at("partitions").get_to(qos.partitions);
    if (!json.contains("presentation")) {
        return qos; // a recording of before these were kept
    }
    if (json.contains("latency_budget_s")) {
        qos.latency_budget_s = duration_of(json.at("latency_budget_s"));
    }
    qos.by_source_timestamp = json.at("destination_order") == "by source timestamp";
    nlohmann::json const& presentation = json.at("presentation");
    qos.scope = named(presentation.at("scope").get<std::string>(),
                      {PresentationScope::instance, PresentationScope::topic, PresentationScope::group});
    presentation.at("coherent").get_to(qos.coherent);
    presentation.at("ordered").get_to(qos.ordered);
    qos.representations.clear();
    for (nlohmann::json const& one : json.at("representations")) {
        qos.representations.push_back(
            named(one.get<std::string>(), {Representation::xcdr1, Representation::xml, Representation::xcdr2}));
    }
    return qos;
}

} // namespace

std::optional<Snapshot> from_json(std::string const& text) try {
    nlohmann::json const json = nlohmann::json::parse(text);
    Snapshot out;
    out.revision = natural<std::uint64_t>(json.at("revision"));
    for (nlohmann::json const& p : json.at("processes")) {
        out.processes.push_back({p.at("name"), p.at("program"), p.at("host"),
                                 named(p.at("state").get<std::string>(), {ProcessState::expected, ProcessState::alive,
                                                                          ProcessState::ended, ProcessState::lost}),
                                 natural<std::uint32_t>(p.at("incarnation")), p.at("addresses"), p.at("networks")});
    }
    for (nlohmann::json const& t : json.at("topics")) {
        out.topics.push_back({t.at("name"), t.at("network"), t.at("type"), t.at("framework"),
                              natural<std::size_t>(t.at("writers")), natural<std::size_t>(t.at("readers")),
                              t.value("not_heard", std::vector<std::string>{})});
    }
    for (nlohmann::json const& e : json.at("edges")) {
        out.edges.push_back({e.at("process"), e.at("topic"), e.at("network"), e.at("writes"),
                             natural<std::size_t>(e.at("endpoints")), e.at("matched"), e.at("problems")});
    }
    for (nlohmann::json const& w : json.at("wires")) {
        out.wires.push_back({w.at("process"), w.at("stream"), w.at("kind"), w.at("link"), w.at("publishes")});
    }
    for (nlohmann::json const& e : json.at("endpoints")) {
        Endpoint endpoint;
        endpoint.endpoint = {e.at("id"),         "", e.at("topic"), e.at("type"), e.at("writer"), e.at("keyed"),
                             qos_of(e.at("qos"))};
        endpoint.network = e.at("network");
        endpoint.process = e.at("process");
        out.endpoints.push_back(std::move(endpoint));
    }
    return out;
} catch (nlohmann::json::exception const&) {
    return std::nullopt;
}

} // namespace gridspace::graph
