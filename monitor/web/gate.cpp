// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/gate.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fstream>
#include <sys/random.h>
#include <sys/stat.h>

namespace gridspace::web {
namespace {

constexpr std::size_t kShortestToken = 16;

/// The page that asks for the token: a form without a script.
std::string login_page(std::string_view complaint) {
    return fmt::format(
        R"(<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Gridspace</title><style>
:root {{ color-scheme: light dark; font: 14px/1.5 system-ui, sans-serif; }}
body {{ display: grid; place-items: center; min-height: 90vh; margin: 0; }}
form {{ display: grid; gap: 12px; width: min(340px, 88vw); }} h1 {{ font-size: 18px; margin: 0; }} p {{ margin: 0; }}
input, button {{ font: inherit; padding: 7px 10px; }} [role=alert] {{ color: #c4162f; font-weight: 600; }}
</style></head><body><form method="post" action="/login">
<h1>Gridspace monitor</h1>
<label for="token">The token of this monitor (its <code>token_file</code>)</label>
<input id="token" name="token" type="password" autocomplete="current-password" required autofocus>
<button>Look at the run</button>{}
</form></body></html>
)",
        complaint.empty() ? "" : fmt::format(R"(<p role="alert">{}</p>)", complaint));
}

Response page(int status, std::string_view complaint) {
    Response out;
    out.status = status;
    out.content_type = "text/html; charset=utf-8";
    out.body = login_page(complaint);
    return out;
}

} // namespace

Gate::Gate(std::vector<std::string> tokens, std::string session, std::uint16_t port, bool secure)
    : tokens_{std::move(tokens)}, session_{std::move(session)},
      cookie_{fmt::format("gridspace_{}", port)}, // browsers keep one jar for all ports of a host
      secure_{secure} {}

bool Gate::is_token(std::string_view text) const {
    bool good = false;
    for (std::string const& token : tokens_) {
        good |= same_secret(text, token);
    }
    return good;
}

bool Gate::admits(std::string_view authorization, std::string_view cookie) const {
    constexpr std::string_view kBearer = "Bearer ";
    if (tokens_.empty() || (authorization.starts_with(kBearer) && is_token(authorization.substr(kBearer.size())))) {
        return true;
    }
    while (!cookie.empty()) { // a=b; c=d
        std::size_t const end = std::min(cookie.find(';'), cookie.size());
        std::string_view pair = cookie.substr(0, end);
        pair.remove_prefix(std::min(pair.find_first_not_of(' '), pair.size()));
        if (pair.size() > cookie_.size() && pair.starts_with(cookie_) && pair[cookie_.size()] == '=' &&
            same_secret(pair.substr(cookie_.size() + 1), session_)) {
            return true;
        }
        cookie.remove_prefix(std::min(end + 1, cookie.size()));
    }
    return false;
}

bool Gate::admits_push(std::string_view authorization, std::string_view cookie, Target& target) const {
    auto const named = target.query.extract("token");
    bool const known = !named.empty() && is_token(named.mapped());
    return known || admits(authorization, cookie);
}

std::optional<Response> Gate::check(Request const& request) const {
    if (tokens_.empty()) {
        return std::nullopt;
    }
    if (request.target.path == "/login") {
        return login(request);
    }
    if (admits(request.authorization, request.cookie)) {
        return std::nullopt;
    }
    if (request.method == "GET" && request.accept.find("text/html") != std::string::npos) {
        return page(401, "");
    }
    Response out;
    out.status = 401;
    out.body = R"({"error":"this monitor asks for a token","remedy":"Authorization: Bearer TOKEN"})";
    return out;
}

Response Gate::login(Request const& request) const {
    if (request.method != "POST") {
        return page(200, "");
    }
    auto const form = parse_target("/?" + request.body); // name=value&…, as in a query
    auto const token = form ? form->query.find("token") : decltype(form->query.find("")){};
    if (!form || token == form->query.end() || !is_token(token->second)) {
        return page(401, "That is not the token.");
    }
    Response out;
    out.status = 303;
    out.content_type = "text/plain";
    out.location = "/";
    out.set_cookie =
        fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", cookie_, session_, secure_ ? "; Secure" : "");
    return out;
}

Result<std::string> make_secret() {
    std::uint8_t octets[16];
    if (::getrandom(octets, sizeof octets, 0) != sizeof octets) {
        return fail(ExitCode::environment, "the kernel gives no random numbers");
    }
    std::string out;
    for (std::uint8_t const octet : octets) {
        out += fmt::format("{:02x}", octet);
    }
    return out;
}

Result<std::string> read_token(std::filesystem::path const& file) {
    struct stat state{};
    std::ifstream stream{file};
    std::string token;
    if (!stream || ::stat(file.c_str(), &state) != 0 || !std::getline(stream, token)) {
        return fail(ExitCode::usage, fmt::format("cannot read a token in '{}'", file.string()),
                    fmt::format("(umask 077; openssl rand -hex 16 > {})", file.string()));
    }
    if ((state.st_mode & 077) != 0) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' can be read by others (mode {:03o})", file.string(), state.st_mode & 0777U),
                    fmt::format("chmod 600 {}, and choose another token", file.string()));
    }
    bool const plain = std::all_of(token.begin(), token.end(), [](unsigned char c) { return std::isgraph(c) != 0; });
    if (token.size() < kShortestToken || !plain) {
        return fail(
            ExitCode::usage, fmt::format("'{}' holds no token", file.string()),
            fmt::format("its first line is at least {} printable characters without blanks that nobody can guess",
                        kShortestToken));
    }
    return token;
}

} // namespace gridspace::web
