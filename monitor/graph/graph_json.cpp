// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/graph_text.hpp"
#include "monitor/graph/match.hpp"

#include <nlohmann/json.hpp>

namespace gridspace::graph {
namespace {

using Json = nlohmann::ordered_json;

Json duration_json(double seconds) {
    return seconds < 0 ? Json(nullptr) : Json(seconds);
}

Json endpoint_json(Endpoint const& e) {
    bus::EndpointQos const& q = e.endpoint.qos;
    Json representations = Json::array();
    for (bus::Representation const one : q.representations) {
        representations.push_back(name_of(one));
    }
    return {{"id", e.endpoint.id},
            {"process", e.process},
            {"network", e.network},
            {"topic", e.endpoint.topic},
            {"type", e.endpoint.type},
            {"writer", e.endpoint.writer},
            {"keyed", e.endpoint.keyed},
            {"qos",
             {{"reliability", q.reliable ? "reliable" : "best effort"},
              {"durability", name_of(q.durability)},
              {"deadline_s", duration_json(q.deadline_s)},
              {"liveliness", name_of(q.liveliness)},
              {"lease_s", duration_json(q.lease_s)},
              {"ownership", q.exclusive ? "exclusive" : "shared"},
              {"partitions", q.partitions},
              {"destination_order", q.by_source_timestamp ? "by source timestamp" : "by reception timestamp"},
              {"presentation", {{"scope", name_of(q.scope)}, {"coherent", q.coherent}, {"ordered", q.ordered}}},
              {"latency_budget_s", duration_json(q.latency_budget_s)},
              {"representations", representations}}}};
}

} // namespace

std::string to_json(Snapshot const& graph) {
    Json processes = Json::array(), topics = Json::array(), edges = Json::array(), wires = Json::array(),
         endpoints = Json::array();
    for (Process const& p : graph.processes) {
        processes.push_back({{"name", p.name},
                             {"program", p.program},
                             {"host", p.host},
                             {"state", name_of(p.state)},
                             {"incarnation", p.incarnation},
                             {"addresses", p.addresses},
                             {"networks", p.networks}});
    }
    for (Topic const& t : graph.topics) {
        topics.push_back({{"name", t.name},
                          {"network", t.network},
                          {"type", t.type},
                          {"framework", t.framework},
                          {"writers", t.writers},
                          {"readers", t.readers},
                          {"not_heard", t.not_heard}});
    }
    for (Edge const& e : graph.edges) {
        edges.push_back({{"process", e.process},
                         {"topic", e.topic},
                         {"network", e.network},
                         {"writes", e.writes},
                         {"endpoints", e.endpoints},
                         {"matched", e.matched},
                         {"problems", e.problems}});
    }
    for (WireEdge const& w : graph.wires) {
        wires.push_back({{"process", w.process},
                         {"stream", w.stream},
                         {"kind", w.kind},
                         {"link", w.link},
                         {"publishes", w.publishes}});
    }
    for (Endpoint const& e : graph.endpoints) {
        endpoints.push_back(endpoint_json(e));
    }
    return Json{
        {"revision", graph.revision}, {"processes", processes}, {"topics", topics}, {"edges", edges}, {"wires", wires},
        {"endpoints", endpoints}}
        .dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace gridspace::graph
