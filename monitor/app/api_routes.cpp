// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Which request is answered by what. openapi.json says the same to others; tests compare the two.
#include "monitor/app/api.hpp"
#include "monitor/app/api_answers.hpp"
#include "monitor/app/metrics.hpp"
#include "monitor/graph/graph_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

/// What "{…}" of `pattern` stands for ("" without one); nothing when the path is another.
std::optional<std::string> match(std::string_view pattern, std::string_view path) {
    std::size_t const open = pattern.find('{');
    if (open == std::string_view::npos) {
        return pattern == path ? std::optional{std::string{}} : std::nullopt;
    }
    std::string_view const before = pattern.substr(0, open), after = pattern.substr(pattern.find('}') + 1);
    if (path.size() <= before.size() + after.size() || !path.starts_with(before) || !path.ends_with(after)) {
        return std::nullopt;
    }
    path.remove_prefix(before.size());
    path.remove_suffix(after.size());
    return std::string{path}; // with slashes, too: topics of others have them in their names
}

/// A switch of the query: missing is off, without a value on; nothing when it is neither on nor off.
std::optional<bool> flag(web::Target const& target, char const* name) {
    auto const it = target.query.find(name);
    std::string const value = it == target.query.end() ? "0" : it->second;
    if (value.empty() || value == "1" || value == "true") {
        return true;
    }
    return value == "0" || value == "false" ? std::optional{false} : std::nullopt;
}

web::Response no_flag(std::string const& name) {
    return problem(400, name + " is on or off", "?" + name + "=1 or ?" + name + "=0");
}

} // namespace

web::Response json_response(std::string body, int status) {
    web::Response response;
    response.status = status;
    response.body = std::move(body);
    return response;
}

web::Response problem(int status, std::string const& what, std::string const& remedy) {
    nlohmann::ordered_json json{{"error", what}};
    if (!remedy.empty()) {
        json["remedy"] = remedy;
    }
    return json_response(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace), status);
}

std::optional<double> number(web::Target const& target, char const* name) {
    auto const it = target.query.find(name);
    if (it == target.query.end()) {
        return std::nullopt;
    }
    double value = NAN;
    auto const [end, error] = std::from_chars(it->second.data(), it->second.data() + it->second.size(), value);
    return error == std::errc{} && end == it->second.data() + it->second.size() ? value : NAN;
}

struct Api::Entry : Api::Route {
    web::Response (*answer)(Api const& api, web::Request const& request, std::string const& segment);
};

std::span<Api::Entry const> Api::entries() {
    using Request = web::Request;
    using Text = std::string;
    static constexpr std::array kEntries{
        // the first that fits answers
        Entry{{"GET", "/api/v1/health"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.health()); }},
        Entry{{"GET", "/api/v1/run"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.run()); }},
        Entry{{"GET", "/api/v1/graph"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.graph()); }},
        Entry{{"GET", "/api/v1/graph.dot"},
              [](Api const& api, Request const& r, Text const&) { return api.picture(r.target, true); }},
        Entry{{"GET", "/api/v1/graph.svg"},
              [](Api const& api, Request const& r, Text const&) { return api.picture(r.target, false); }},
        Entry{{"GET", "/api/v1/network"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.network()); }},
        Entry{{"GET", "/api/v1/verdict"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.verdict()); }},
        Entry{{"GET", "/api/v1/topics"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.topics()); }},
        Entry{{"GET", "/api/v1/topics/{topic}/last"},
              [](Api const& api, Request const& r, Text const& topic) {
                  auto const cdr = flag(r.target, "cdr");
                  return cdr ? api.last_samples(topic, *cdr) : no_flag("cdr");
              }},
        Entry{{"GET", "/api/v1/topics/{topic}"},
              [](Api const& api, Request const&, Text const& topic) { return api.topic(topic); }},
        Entry{{"GET", "/api/v1/streams"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.streams()); }},
        Entry{{"GET", "/api/v1/signals"},
              [](Api const& api, Request const&, Text const&) { return json_response(api.signals()); }},
        Entry{{"GET", "/api/v1/signals/query"},
              [](Api const& api, Request const& r, Text const&) { return api.signal_query(r.target); }},
        Entry{{"GET", "/api/v1/events"},
              [](Api const& api, Request const& r, Text const&) { return api.event_query(r.target); }},
        Entry{{"POST", "/api/v1/control"},
              [](Api const& api, Request const& r, Text const&) { return api.control(r); }},
        Entry{{"GET", "/metrics"}, [](Api const& api, Request const&, Text const&) { return api.metrics(); }},
    };
    return kEntries;
}

std::span<Api::Route const> Api::routes() {
    static std::vector<Route> const all{entries().begin(), entries().end()};
    return all;
}

web::Response Api::picture(web::Target const& target, bool dot) const {
    auto const asked = flag(target, "framework");
    if (!asked) {
        return no_flag("framework");
    }
    std::unique_lock lock{run_.mutex};
    graph::Snapshot const snapshot = run_.snapshot();
    lock.unlock();
    bool const framework = *asked;
    web::Response response;
    response.content_type = dot ? "text/vnd.graphviz; charset=utf-8" : "image/svg+xml";
    response.body = dot ? graph::to_dot(snapshot, framework) : graph::to_svg(snapshot, framework);
    return response;
}

web::Response Api::event_query(web::Target const& target) const {
    double const after = number(target, "after").value_or(0);
    if (!(after >= 0 && after < 1e15) || after != std::floor(after)) {
        return problem(400, "`after` is the number of an event", "?after=0 and whole numbers beyond");
    }
    return json_response(events(static_cast<std::uint64_t>(after), 1000));
}

web::Response Api::metrics() const {
    web::Response response;
    response.content_type = "text/plain; version=0.0.4; charset=utf-8";
    response.body = metrics_text(run_, counters_());
    return response;
}

web::Response Api::answer(web::Request const& request) const {
    std::string_view const method = request.method == "HEAD" ? "GET" : std::string_view{request.method};
    std::string allow;
    for (Entry const& entry : entries()) {
        auto const segment = match(entry.path, request.target.path);
        if (segment && entry.method == method) {
            return entry.answer(*this, request, *segment);
        }
        if (segment) {
            allow = entry.method == "GET" ? "GET, HEAD" : entry.method;
        }
    }
    if (allow.empty()) {
        return problem(404, "there is nothing at " + request.target.path,
                       "GET /api/v1/openapi.json lists what there is");
    }
    web::Response refused = problem(405, allow == "POST" ? "this is asked for by POST" : "nothing here can be changed");
    refused.allow = allow;
    return refused;
}

} // namespace gridspace::monitor
