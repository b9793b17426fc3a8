// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/api.hpp"

#include "bus/topics.hpp"
#include "common/text.hpp"
#include "common/version.hpp"
#include "monitor/app/api_answers.hpp"
#include "monitor/app/json_text.hpp"
#include "monitor/app/sample_json.hpp"
#include "monitor/graph/graph_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxColumns = 10000; ///< of a query

/// Adds what a process uses, as far as it is known.
void add_use(Json& entry, LiveRun const& run, std::string const& process) {
    auto const it = run.use.find(process);
    if (it == run.use.end()) {
        return;
    }
    auto const tenths = [](double v) { return std::round(10 * v) / 10; };
    entry["cpu_s"] = it->second.cpu_s;
    if (it->second.cpu_percent) {
        entry["cpu_percent"] = tenths(*it->second.cpu_percent);
    }
    if (it->second.memory_octets) {
        entry["memory_octets"] = *it->second.memory_octets;
    }
}

web::Response unseen(std::string const& topic) {
    return problem(404, "there is no topic '" + topic + "'", "GET /api/v1/topics or `gridspace topic list` lists them");
}

} // namespace

Api::Api(LiveRun const& run, std::function<web::ServerCounters()> counters)
    : run_{run}, counters_{std::move(counters)} {}

std::string Api::health() const {
    std::chrono::duration<double> const up = std::chrono::steady_clock::now() - run_.started;
    Json processes = Json::array();
    std::lock_guard const lock{run_.mutex};
    for (graph::Process const& process : run_.snapshot().processes) {
        Json entry{{"name", process.name}, {"state", graph::name_of(process.state)}};
        add_use(entry, run_, process.name);
        processes.push_back(std::move(entry));
    }
    return json_text({{"status", "ok"},
                      {"version", version().version},
                      {"commit", version().commit},
                      {"uptime_s", std::floor(up.count())},
                      {"processes", std::move(processes)}});
}

std::string Api::run() const {
    std::lock_guard const lock{run_.mutex};
    RunClock const& clock = run_.clock;
    graph::Snapshot const& graph = run_.snapshot();
    Json processes = Json::array();
    for (graph::Process const& process : graph.processes) {
        Json entry{{"name", process.name},
                   {"program", process.program},
                   {"host", process.host},
                   {"state", graph::name_of(process.state)},
                   {"incarnation", process.incarnation}};
        // A process that is idle is not awaited: its last acknowledgement may be old without any harm.
        if (auto const it = run_.acknowledged.find(process.name); it != run_.acknowledged.end()) {
            entry["tick"] = it->second.tick;
        }
        add_use(entry, run_, process.name);
        processes.push_back(std::move(entry));
    }
    Json out{{"scenario", run_.plan.scenario},
             {"mode", run_.plan.mode},
             {"speed", run_.plan.speed},
             {"recorded", run_.recorded},
             {"control", !token_.empty()},
             {"state", clock.paused && clock.state == "running" ? "paused" : clock.state},
             {"time_s", clock.time_s},
             {"duration_s", run_.plan.duration_s},
             {"tick", clock.tick},
             {"factor", clock.factor},
             {"events", run_.events_seen},
             {"graph_revision", graph.revision},
             {"processes", std::move(processes)}};
    return json_text(out);
}

std::string Api::graph() const {
    std::lock_guard const lock{run_.mutex};
    return graph::to_json(run_.snapshot());
}

std::string Api::topics() const {
    std::lock_guard const lock{run_.mutex};
    Json out = Json::array();
    std::vector<graph::Topic> topics = run_.snapshot().topics;
    for (auto const& [key, state] : run_.topics) { // of a recorded run nobody may have seen who read it
        bool const known = std::any_of(topics.begin(), topics.end(),
                                       [&](auto const& t) { return t.network == key.first && t.name == key.second; });
        if (!known) {
            topics.push_back({state.topic, state.network, state.type, bus::is_management_topic(state.topic), 0, 0});
        }
    }
    for (graph::Topic const& topic : topics) {
        Json entry{{"name", topic.name},           {"network", topic.network}, {"type", topic.type},
                   {"framework", topic.framework}, {"writers", topic.writers}, {"readers", topic.readers}};
        auto const it = run_.topics.find({topic.network, topic.name});
        bool const seen = it != run_.topics.end();
        entry["samples"] = seen ? it->second.samples : 0;
        entry["octets"] = seen ? it->second.octets : 0;
        entry["samples_per_second"] = seen ? it->second.per_second : 0.0;
        entry["not_heard"] = topic.not_heard;
        out.push_back(std::move(entry));
    }
    return json_text({{"topics", std::move(out)}});
}

std::optional<std::pair<TopicState, std::string>> Api::topic_state(std::string const& name) const {
    std::lock_guard const lock{run_.mutex};
    auto const it =
        std::find_if(run_.topics.begin(), run_.topics.end(), [&](auto const& t) { return t.first.second == name; });
    TopicState state;
    if (it != run_.topics.end()) {
        state = it->second;
    } else { // somebody may be there who has not written anything yet
        std::vector<graph::Topic> const& topics = run_.snapshot().topics;
        auto const known =
            std::find_if(topics.begin(), topics.end(), [&](graph::Topic const& t) { return t.name == name; });
        if (known == topics.end()) {
            return std::nullopt;
        }
        state.network = known->network;
        state.topic = known->name;
        state.type = known->type;
    }
    auto const idl = run_.idl.find(state.type);
    std::string text = idl != run_.idl.end() ? idl->second : std::string{bus::idl_of_type(state.type)};
    return std::pair{std::move(state), std::move(text)};
}

std::vector<std::string> Api::not_heard(TopicState const& state) const {
    std::lock_guard const lock{run_.mutex};
    for (graph::Topic const& topic : run_.snapshot().topics) {
        if (topic.name == state.topic && topic.network == state.network) {
            return topic.not_heard;
        }
    }
    return {};
}

web::Response Api::topic(std::string const& name) const {
    auto const found = topic_state(name);
    if (!found) {
        return unseen(name);
    }
    auto const& [state, idl] = *found;
    return json_response(json_text({{"name", state.topic},
                                    {"network", state.network},
                                    {"type", state.type},
                                    {"samples", state.samples},
                                    {"octets", state.octets},
                                    {"samples_per_second", state.per_second},
                                    {"not_heard", not_heard(state)},
                                    {"idl", idl}}));
}

web::Response Api::last_samples(std::string const& name, bool cdr) const {
    auto const found = topic_state(name);
    if (!found) {
        return unseen(name);
    }
    auto const& [state, idl] = *found;
    // The newest sample of each key, as far as the last few samples know.
    Json samples = Json::array();
    std::vector<std::string> keys;
    for (auto it = state.newest.rbegin(); it != state.newest.rend(); ++it) {
        Json sample = sample_to_json(idl, state.type, it->cdr);
        std::string const key =
            sample.value("key", std::string{}) + '\n' + (sample.contains("error") ? it->process : "");
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
            keys.push_back(key);
            Json entry{{"process", it->process}, {"number", it->number}, {"octets", it->cdr.size()}};
            entry.update(sample);
            if (cdr) {
                std::string digits;
                for (std::byte const octet : it->cdr) {
                    digits += fmt::format("{:02x}", static_cast<unsigned>(octet));
                }
                entry["cdr"] = std::move(digits);
            }
            samples.push_back(std::move(entry));
        }
    }
    std::sort(samples.begin(), samples.end(),
              [](Json const& a, Json const& b) { return a.value("key", "") < b.value("key", ""); });
    return json_response(json_text({{"name", state.topic},
                                    {"network", state.network},
                                    {"type", state.type},
                                    {"samples", state.samples},
                                    {"not_heard", not_heard(state)},
                                    {"last", std::move(samples)}}));
}

std::string Api::streams() const {
    struct Stream {
        std::string kind, link;
        std::vector<std::string> from, to;
        Json figures = Json::object(), counted = Json::array();
    };
    std::lock_guard const lock{run_.mutex};
    std::map<std::string, Stream> streams;
    for (graph::WireEdge const& wire : run_.snapshot().wires) {
        Stream& stream = streams[wire.stream];
        stream.kind = wire.kind;
        stream.link = wire.link;
        (wire.publishes ? stream.from : stream.to).push_back(wire.process);
    }
    for (auto const& [key, window] : run_.signals) { // stream.SMV21.lost
        for (std::size_t c = 0; window != nullptr && !window->empty() && c < window->columns().size(); ++c) {
            std::vector<std::string> const parts = split(window->columns()[c].name, '.');
            auto const it = parts.size() == 3 && parts[0] == "stream" ? streams.find(parts[1]) : streams.end();
            if (it != streams.end()) {
                it->second.figures[parts[2]] = window->newest(c); // NaN becomes null
            }
        }
    }
    for (auto const& [key, end] : run_.stream_ends) {
        if (auto const it = streams.find(key.first); it != streams.end()) {
            it->second.counted.push_back({{"process", key.second},
                                          {"sends", end.sends},
                                          {"state", end.state},
                                          {"time_s", end.time_s},
                                          {"frames", end.frames},
                                          {"rate_hz", end.rate_hz},
                                          {"lost", end.lost},
                                          {"duplicate", end.duplicate},
                                          {"late", end.late},
                                          {"refused", end.refused},
                                          {"silences", end.silences},
                                          {"dropped", end.dropped}});
        }
    }
    Json out = Json::array();
    for (auto& [name, stream] : streams) {
        out.push_back({{"name", name},
                       {"kind", stream.kind},
                       {"link", stream.link},
                       {"from", stream.from},
                       {"to", stream.to},
                       {"figures", std::move(stream.figures)},
                       {"counted", std::move(stream.counted)}});
    }
    return json_text({{"streams", std::move(out)}});
}

std::string Api::signals() const {
    std::lock_guard const lock{run_.mutex};
    Json out = Json::array();
    for (auto const& [key, window] : run_.signals) {
        if (window == nullptr) {
            continue;
        }
        for (std::size_t c = 0; c < window->columns().size(); ++c) {
            Json entry{{"name", window->columns()[c].name}, {"unit", window->columns()[c].unit}, {"source", key.first}};
            entry["steps"] = window->columns()[c].steps;
            if (!window->empty()) {
                entry["time_s"] = static_cast<double>(window->newest_ns()) * 1e-9;
                entry["value"] = window->newest(c);
            }
            out.push_back(std::move(entry));
        }
    }
    return json_text({{"signals", std::move(out)}});
}

web::Response Api::signal_query(web::Target const& target) const {
    auto const names = target.query.find("names");
    if (names == target.query.end() || names->second.empty()) {
        return problem(400, "which signals?", "?names=bus.B1.v_pu,bus.B2.v_pu&t0=0&t1=3600&px=800");
    }
    std::optional<double> const t0 = number(target, "t0"), t1 = number(target, "t1"), px = number(target, "px");
    for (auto const& value : {t0, t1, px}) {
        if (value && !std::isfinite(*value)) {
            return problem(400, "t0, t1 (seconds of simulated time) and px (columns) are numbers");
        }
    }
    if (t0 && t1 && *t1 < *t0) {
        return problem(400, fmt::format("t1 ({} s) is before t0 ({} s)", shortest(*t1), shortest(*t0)),
                       "t0 is where the stretch begins, t1 where it ends");
    }
    if (px && (*px < 1 || *px > kMaxColumns || *px != std::floor(*px))) {
        return problem(400, "px is '" + target.query.at("px") + "'",
                       fmt::format("a whole number of columns, 1 to {}", kMaxColumns));
    }
    std::vector<std::string> const wanted = split(names->second, ',');
    if (wanted.size() > 64) {
        return problem(400, "at most 64 signals at once");
    }
    auto const ns = [](double s) { return static_cast<std::int64_t>(std::llround(std::clamp(s * 1e9, -9e18, 9e18))); };
    auto const pixels = static_cast<std::size_t>(px.value_or(800));
    Json series = Json::array();
    std::lock_guard const lock{run_.mutex};
    for (std::string const& name : wanted) {
        auto const [window, column] = run_.find_signal(name);
        if (window == nullptr) {
            return problem(404, "there is no signal '" + name + "'", "GET /api/v1/signals lists them");
        }
        stream::Plot const plot =
            window->plot(column, ns(t0.value_or(-1e9)), ns(t1.value_or(9e9)), pixels, stream::Ends::inside);
        series.push_back(
            {{"name", name}, {"unit", window->columns()[column].unit}, {"t", plot.times_s}, {"v", plot.values}});
    }
    return json_response(json_text({{"series", std::move(series)}}));
}

std::string Api::events(std::uint64_t after, std::size_t most) const {
    std::lock_guard const lock{run_.mutex};
    Json out = Json::array();
    for (RunEvent const& event : run_.events) {
        if (event.number > after && out.size() < most) {
            out.push_back({{"number", event.number},
                           {"time_s", event.time_s},
                           {"source", event.source},
                           {"event", event.event},
                           {"text", event.text}});
        }
    }
    return json_text({{"events", std::move(out)}});
}

void Api::allow_control(std::string token, std::function<void(std::string const&)> act) {
    token_ = std::move(token);
    act_ = std::move(act);
}

web::Response Api::control(web::Request const& request) const {
    if (token_.empty()) {
        return problem(403, "this run may not be controlled", "start it with gridspace run --allow-control");
    }
    constexpr std::string_view kBearer = "Bearer ";
    if (!request.authorization.starts_with(kBearer) ||
        !web::same_secret(std::string_view{request.authorization}.substr(kBearer.size()), token_)) {
        return problem(401, "the token is missing or wrong", "it is in the file control.token of the run folder");
    }
    Json const body = Json::parse(request.body, nullptr, false);
    std::string const action = body.is_object() && body.contains("action") && body["action"].is_string()
                                   ? body["action"].get<std::string>()
                                   : std::string{};
    auto const is_step = [&] {
        std::uint64_t ticks = 0;
        char const* const begin = action.data() + 5;
        auto const [end, error] = std::from_chars(begin, action.data() + action.size(), ticks);
        return error == std::errc{} && end == action.data() + action.size() && ticks > 0;
    };
    bool const stop = action == "stop", step = action.starts_with("step ") && is_step();
    if (!stop && !step && action != "pause" && action != "continue") {
        return problem(400, "what shall be done?", R"({"action": "pause"}, or "continue", "step 3", "stop")");
    }
    if (!stop && run_.plan.mode != "lockstep") {
        return problem(409, "a run in real time cannot be halted", R"(only {"action": "stop"} works here)");
    }
    act_(action);
    return json_response(json_text({{"accepted", action}}), 202);
}

} // namespace gridspace::monitor
