// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/breakdown.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(Proportion const& p) {
    return {{"successes", p.successes}, {"of", p.of}, {"share", p.estimate}, {"low", p.low}, {"high", p.high}};
}

} // namespace

std::string certificate_json(CertifyCase const& all, std::vector<GroupResult> const& groups, Certificate const& c) {
    Json out{{"case", all.name},
             {"passed", c.is_passed()},
             {"confidence", all.confidence},
             {"interval", "Clopper-Pearson"},
             {"dependability", json_of(c.dependability)},
             {"security", json_of(c.security)},
             {"inconclusive", c.inconclusive},
             {"open", c.open}};
    out["trip_ms"] = {{"count", c.trip_ms.size()},
                      {"mean", c.mean_ms},
                      {"deviation", c.deviation_ms},
                      {"min", c.trip_ms.empty() ? Json(nullptr) : Json(c.trip_ms.front())},
                      {"median", c.median_ms},
                      {"p95", c.p95_ms},
                      {"max", c.trip_ms.empty() ? Json(nullptr) : Json(c.trip_ms.back())}};
    out["criteria"] = Json::array();
    for (Judged const& j : c.criteria) {
        out["criteria"].push_back({{"name", j.name},
                                   {"value", j.value ? Json(*j.value) : Json(nullptr)},
                                   {"limit", j.limit},
                                   {"met", j.met}});
    }
    out["by_value"] = Json::array();
    for (Share const& share : breakdown(all, groups)) {
        Json row{{"parameter", share.parameter}, {"value", share.value}, {"right", json_of(share.right)}};
        row["slowest_ms"] = share.trip_ms.empty() ? Json(nullptr) : Json(std::ranges::max(share.trip_ms));
        out["by_value"].push_back(std::move(row));
    }
    out["worst"] = Json::array();
    for (WorstFault const& f : c.worst) {
        GroupResult const& group = groups[f.group];
        out["worst"].push_back({{"group", group.group.name.name},
                                {"run", f.run + 1},
                                {"why", f.why},
                                {"fault", describe(group.study, group.plan.runs[f.run])},
                                {"command", f.command},
                                {"folder", f.folder.string()}});
    }
    out["groups"] = Json::array();
    for (GroupResult const& group : groups) {
        out["groups"].push_back({{"name", group.group.name.name},
                                 {"must", group.group.must_trip ? "trip" : "stay"},
                                 {"runs", group.plan.runs.size()},
                                 {"passed", group.finished.count("passed")},
                                 {"failed", group.finished.count("failed")},
                                 {"ended_early", group.finished.count("ended_early")},
                                 {"folder", group.finished.folder.root.string()}});
    }
    return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace gridspace::launcher
