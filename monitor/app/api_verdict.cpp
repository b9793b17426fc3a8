// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/api.hpp"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

/// What the launcher wrote when the run had ended; null where there is none, or it is damaged.
Json summary_beside(std::filesystem::path const& events) {
    std::ifstream stream{events.parent_path() / "report" / "summary.json"};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    Json summary = Json::parse(text, nullptr, false);
    return summary.is_object() ? summary : Json(nullptr);
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
    Json const summary = recorded ? summary_beside(plan.events) : Json(nullptr);
    Json const judged = member(summary, "expectations");
    Json expectations = Json::array();
    for (RunPlan::Expectation const& e : plan.expectations) {
        Json entry{{"name", e.name},         {"rule", e.rule},   {"accepted", e.accepted}, {"unit", e.unit},
                   {"advisory", e.advisory}, {"value", nullptr}, {"pass", nullptr},        {"detail", ""}};
        for (Json const& result : judged) {
            if (member(result, "name") == e.name) {
                for (char const* key : {"value", "unit", "pass", "detail"}) {
                    entry[key] = member(result, key);
                }
            }
        }
        expectations.push_back(std::move(entry));
    }
    Json out{{"judged", judged.is_array()}, {"expectations", expectations}};
    for (char const* key : {"exit", "cause", "simulated_s", "wall_s", "overruns"}) {
        if (Json value = member(summary, key); !value.is_null()) {
            out[key] = std::move(value);
        }
    }
    return out.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace gridspace::monitor
