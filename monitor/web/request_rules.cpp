// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/request_rules.hpp"

#include <algorithm>
#include <cctype>

namespace gridspace::web {
namespace {

constexpr std::size_t kLongestTarget = 4096;

int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

std::optional<std::string> decode(std::string_view text, bool plus_is_space) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        char c = text[i];
        if (c == '%') {
            int const high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
            int const low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
            if (high < 0 || low < 0) {
                return std::nullopt;
            }
            c = static_cast<char>(high * 16 + low);
            i += 2;
        } else if (c == '+' && plus_is_space) {
            c = ' ';
        }
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            return std::nullopt;
        }
        out += c;
    }
    return out;
}

bool is_plain_path(std::string_view path) {
    if (path.empty() || path.front() != '/' || path.find('\\') != std::string_view::npos) {
        return false;
    }
    for (std::size_t begin = 1; begin <= path.size();) {
        std::size_t const end = std::min(path.find('/', begin), path.size());
        std::string_view const segment = path.substr(begin, end - begin);
        bool const last = end == path.size();
        if (segment == "." || segment == ".." || (segment.empty() && !last)) {
            return false;
        }
        begin = end + 1;
    }
    return true;
}

std::string lower(std::string_view text) {
    std::string out{text};
    std::transform(out.begin(), out.end(), out.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return out;
}

/// "name" of "name:port"; nothing when the port is not a number.
std::optional<std::string> without_port(std::string_view host) {
    std::size_t const colon = host.rfind(':');
    std::size_t const bracket = host.rfind(']');
    if (colon == std::string_view::npos || (bracket != std::string_view::npos && colon < bracket)) {
        return lower(host);
    }
    std::string_view const port = host.substr(colon + 1);
    bool const number = !port.empty() && port.size() <= 5 &&
                        std::all_of(port.begin(), port.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    return number ? std::optional{lower(host.substr(0, colon))} : std::nullopt;
}

} // namespace

std::optional<Target> parse_target(std::string_view target) {
    if (target.size() > kLongestTarget) {
        return std::nullopt;
    }
    std::size_t const question = std::min(target.find('?'), target.size());
    auto path = decode(target.substr(0, question), false);
    if (!path || !is_plain_path(*path)) {
        return std::nullopt;
    }
    Target out{std::move(*path), {}};
    std::string_view rest = target.substr(std::min(question + 1, target.size()));
    while (!rest.empty()) {
        std::size_t const end = std::min(rest.find('&'), rest.size());
        std::string_view const pair = rest.substr(0, end);
        std::size_t const equals = std::min(pair.find('='), pair.size());
        auto name = decode(pair.substr(0, equals), true);
        auto value = decode(pair.substr(std::min(equals + 1, pair.size())), true);
        if (!name || !value) {
            return std::nullopt;
        }
        if (!name->empty()) {
            out.query[*name] = std::move(*value);
        }
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return out;
}

bool host_allowed(Sites const& sites, std::string_view host) {
    auto const name = without_port(host);
    return name && std::find(sites.hosts.begin(), sites.hosts.end(), *name) != sites.hosts.end();
}

bool origin_allowed(Sites const& sites, std::string_view origin) {
    if (origin.empty()) {
        return true;
    }
    for (std::string_view const scheme : {"http://", "https://"}) {
        if (origin.starts_with(scheme)) {
            return host_allowed(sites, origin.substr(scheme.size()));
        }
    }
    return false; // "null" too: a sandboxed page or a file
}

bool same_secret(std::string_view a, std::string_view b) {
    unsigned difference = a.size() == b.size() ? 0U : 1U;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.empty() ? 0 : b[i % b.size()]);
    }
    return difference == 0;
}

} // namespace gridspace::web
