// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a request must look like before anything looks at its meaning. Pure: text in, verdict out.
namespace gridspace::web {

/// A request target, taken apart and percent-decoded once.
struct Target {
    std::string path;                         ///< "/api/v1/topics"
    std::map<std::string, std::string> query; ///< the last one wins
};

/// Nothing for anything that is not an absolute path of plain names: "..", empty or dot segments, back slashes, control
/// characters (also when percent-encoded), broken escapes, absolute URLs, more than 4096 characters.
[[nodiscard]] std::optional<Target> parse_target(std::string_view target);

/// Whose pages may talk to us. A name resolved to this machine by a stranger's DNS (rebinding) is not in the list.
struct Sites {
    std::vector<std::string> hosts{"127.0.0.1", "localhost", "[::1]"}; ///< without port
};

/// The Host header names one of our sites, with any port (a tunnel may change it).
[[nodiscard]] bool host_allowed(Sites const& sites, std::string_view host);
/// No Origin (not a browser), or a page of one of our sites.
[[nodiscard]] bool origin_allowed(Sites const& sites, std::string_view origin);

/// Compares in a time that depends on the lengths only.
[[nodiscard]] bool same_secret(std::string_view a, std::string_view b);

} // namespace gridspace::web
