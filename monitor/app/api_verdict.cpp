// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/api.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// A file of the run folder; null where there is none, or it is damaged.
Json read_object(std::filesystem::path const& file) {
    std::ifstream stream{file};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    Json object = Json::parse(text, nullptr, false);
    return object.is_object() ? object : Json(nullptr);
}

/// A member, or null: of an older version it may be missing.
Json member(Json const& object, char const* name) {
    return object.is_object() && object.contains(name) ? object[name] : Json(nullptr);
}

} // namespace

std::string Api::verdict() const {
    std::unique_lock lock{run_.mutex};
    RunPlan const& plan = run_.plan;
    bool const recorded = run_.recorded;
    lock.unlock();
    // The launcher writes one while the run goes on, and the other when it has ended.
    std::filesystem::path const folder = plan.events.parent_path();
    Json const summary = recorded ? read_object(folder / "report" / "summary.json") : Json(nullptr);
    Json const so_far = recorded ? Json(nullptr) : read_object(folder / "so_far.json");
    Json const judged = member(summary, "expectations"), standing = member(so_far, "expectations");
    Json expectations = Json::array();
    for (RunPlan::Expectation const& e : plan.expectations) {
        Json entry{{"name", e.name},  {"rule", e.rule},         {"accepted", e.accepted},
                   {"unit", e.unit},  {"advisory", e.advisory}, {"value", nullptr},
                   {"pass", nullptr}, {"detail", ""},           {"standing", nullptr}};
        for (Json const& result : judged) {
            if (member(result, "name") == e.name) {
                for (char const* key : {"value", "unit", "pass", "detail"}) {
                    entry[key] = member(result, key);
                }
            }
        }
        for (Json const& one : standing) {
            if (member(one, "name") == e.name) {
                for (char const* key : {"value", "unit", "standing", "detail"}) {
                    entry[key] = member(one, key);
                }
            }
        }
        expectations.push_back(std::move(entry));
    }
    Json out{{"judged", judged.is_array()}, {"expectations", expectations}};
    if (Json reached = member(so_far, "reached_s"); !reached.is_null()) {
        out["reached_s"] = std::move(reached);
    }
    for (char const* key : {"exit", "cause", "simulated_s", "wall_s", "overruns"}) {
        if (Json value = member(summary, key); !value.is_null()) {
            out[key] = std::move(value);
        }
    }
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace gridspace::monitor
